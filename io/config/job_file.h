// Job files: what to fit to which recordings, in YAML. docs/job-file.md tells of every
// key.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fit/design/experiment.h"
#include "io/config/key.h"
#include "io/recording/table.h"
#include "io/results/output_folder.h"
#include "sim/rig.h"

namespace axisfit {

/// A job with what only its files know.
struct JobFile {
  Job job;
  Rig rig;                         ///< of the axis file, with the job's effects
  std::string axis_file;           ///< as found
  std::string text, axis_text;     ///< what stood in the two files when they were read
  std::vector<std::string> files;  ///< all that were read, with the recordings, as found
};

/// The keys of a job file.
const Section& job_keys();

/// Reads a job file, its axis file and its recordings. Recordings with relative paths are looked
/// for below `data_directory`, or next to the job file where that is empty. Throws ConfigError with
/// everything that is wrong.
JobFile read_job_file(const std::string& path, const std::string& data_directory = {});

/// The same for a job that is yet to be written: as if `files`, the last of which is the job, were
/// in `folder`, which need not exist. `tables` stand for recordings of these names.
JobFile read_job_draft(const Files& files, const std::string& folder, Tables tables = {});

/// A file that names a job for each of several axes of one machine.
struct AxesJob {
  std::vector<std::pair<std::string, std::string>> jobs;  ///< names of axes, paths as found
};

/// The keys of such a file.
const Section& axes_job_keys();

/// Reads it; none for a file without the key `axes`. Throws ConfigError with everything that is
/// wrong.
std::optional<AxesJob> read_axes_job(const std::string& path);

}  // namespace axisfit
