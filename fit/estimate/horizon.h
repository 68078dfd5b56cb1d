// The choice of the horizon: how far ahead the simulation of a fit predicts.
//
// An incomplete model has different parameters with each horizon. The fitted recordings alone
// decide which of them predict best: each of their stretches is left out once, the rest is fitted
// with every horizon, and the model then runs free through that stretch.
#pragma once

#include <stdexcept>
#include <vector>

#include "fit/data/job.h"
#include "fit/solve/run_context.h"

namespace axisfit {

/// One of the criteria, and how it did.
struct HorizonTrial {
  Criterion criterion;
  /// Rms error of the free run over the stretches left out and the fitted signals, per standard
  /// deviation of the signal. The run begins with the state that suits the first tenth of the
  /// stretch best. Infinite where a fit or a run failed.
  double error = 0.0;
};

struct HorizonChoice {
  int stretches = 0;     ///< that were left out in turn
  double longest = 0.0;  ///< s, the longest of them
  std::vector<HorizonTrial> trials;
  std::size_t chosen = 0;  ///< with the smallest error

  const HorizonTrial& best() const { return trials[chosen]; }
};

/// No horizon can be chosen: the model cannot be simulated at the start, or every horizon fails.
struct NoHorizon : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Tries horizons from a hundredth of a stretch to all of it, the whole recordings, and one step
/// ahead, unless the signal that is tracked lags. The job's recordings must have windows, see
/// window_starts(). Throws NoHorizon, and Interrupted after a stop.
HorizonChoice choose_horizon(const Job& job, const RunContext& context = {});

}  // namespace axisfit
