// report.html: what was found as one page that needs nothing besides itself.
#pragma once

#include <string>

#include "fit/run.h"

namespace axisfit {

/// What a reader needs to do it again.
struct Provenance {
  std::string command;             ///< as one would type it
  std::string job_file, job_text;  ///< name and contents
  std::string axis_file, axis_text;
};

/// The page: the verdict, the recordings, the parameters, the residual, the loop, how it converged,
/// and how to repeat it. Charts are SVG, and live where the program was built with its script.
std::string report_page(const RunResult& run_result, const Provenance& run);

}  // namespace axisfit
