// The files of a result folder.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fit/run.h"
#include "io/config/job_file.h"
#include "io/results/output_folder.h"

namespace axisfit {

inline constexpr std::string_view kResultFile = "result.json";

/// All that results can have.
std::vector<ResultName> result_names();

/// How a run came about, for the reader of its files.
struct ResultOrigin {
  std::string command;  ///< as one would type it
  std::string job;      ///< the job file
  std::string data;     ///< folder of the recordings; empty: next to the job
  std::string output;   ///< folder of the results; empty: no job goes on from there
};

/// What a run leaves in a folder. `json` is its result.json.
Files result_files(const JobFile& file, const RunResult& run_result, const std::string& json,
                   const ResultOrigin& origin);

}  // namespace axisfit
