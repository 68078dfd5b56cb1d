// The result of a fit as text for a terminal.
#pragma once

#include <string>

#include "apps/job_file.h"
#include "fit/estimate.h"

namespace axisfit {

/// Recordings, table of parameters, errors per signal, verdict; lines end with '\n'.
std::string report_text(const JobFile& file, const FitResult& result);

/// residuals.csv: recording (its number in the job), time_s, and measured, simulated and residual
/// of every signal, of the free-running simulation. Empty where a recording lacks a signal.
std::string residuals_csv(const Job& job, const FitResult& result);

}  // namespace axisfit
