// Run-time estimate of a fit and of an effect selection.
#pragma once

#include "fit/data/job.h"

namespace axisfit {

/// The duration of a run, s, with the analysis of its residual. It depends on what the fit finds: a
/// model that explains the recordings ends at once, any other makes further attempts.
struct RunTimeEstimate {
  double evaluation = 0.0;  ///< measured: one simulation of all that is fitted, with derivatives

  double explained = 0.0;    ///< a fit whose model explains the recordings
  double unexplained = 0.0;  ///< one whose model does not

  // Fit and effect selection
  double nothing_missing = 0.0;  ///< where the model explains the recordings
  double one_effect = 0.0;       ///< where it does with one effect more
  double no_effect = 0.0;        ///< where no effect suffices
};

/// Measures one evaluation at the initial values, and multiplies by the number of evaluations that
/// such runs take (bench/run_times.py): within a factor of 3 as a rule, and within 10 where no
/// effect suffices.
RunTimeEstimate estimate_run_time(const Job& job);

}  // namespace axisfit
