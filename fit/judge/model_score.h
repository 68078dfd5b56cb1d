// How far a fitted model is from every recorded signal.
#pragma once

#include <optional>
#include <vector>

#include "fit/judge/missing_force.h"
#include "fit/judge/series.h"

namespace axisfit {

struct SignalErrors {
  double rmse = 0.0;           ///< in the signal's unit
  double nrmse_percent = 0.0;  ///< of the measured range
  double reduced_chi_square = 0.0;
};

/// The errors of one signal of one recording over the samples that were fitted, or over those that
/// were not.
struct SignalScore : SeriesKey {
  std::optional<SignalErrors> free_running;  ///< none where that did not finish
  std::optional<SignalErrors> tracking;  ///< with an observer, where the fit kept one to its end

  const std::optional<SignalErrors>& as_fitted() const {
    return tracking ? tracking : free_running;
  }
};

struct ModelScore {
  std::vector<SignalScore> signals;  ///< without those that are only compared
  std::vector<MissingForce> forces;  ///< of every recording
};

ModelScore score_of(const Job& job, const FitResult& fit);

}  // namespace axisfit
