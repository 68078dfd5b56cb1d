// Run-time estimate of a fit.
#pragma once

#include "fit/data/job.h"

namespace axisfit {

struct RunTimeEstimate {
  double evaluation = 0.0;  ///< s, measured: one simulation of all that is fitted, with derivatives
  double expected = 0.0;    ///< s, of the fit and the look at its residual; an order of magnitude
};

/// Measures one evaluation at the initial values, and multiplies by the number of evaluations that
/// such a job usually takes. A fit that does not explain its recordings makes further attempts and
/// takes up to ten times as long.
RunTimeEstimate estimate_run_time(const Job& job);

}  // namespace axisfit
