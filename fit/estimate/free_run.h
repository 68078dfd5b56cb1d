// The errors of free runs through parts of a recording.
#pragma once

#include <span>
#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// For every window of about `horizon` seconds, the mean over the fitted signals of the squared
/// error of a free run, per variance of the signal, with these values of the job's free parameters.
/// The run begins with the state that suits the first tenth of the window best: a prediction starts
/// from a known state, and knows no more. (Where window_starts() has none, all windows are of one
/// run.) The error is not a number for a window without samples that count; the list is empty where
/// the run does not finish.
std::vector<double> free_run_errors(Job job, std::span<const double> values, std::size_t recording,
                                    double horizon);

}  // namespace axisfit
