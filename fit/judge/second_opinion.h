// Uses of the inverse-dynamics estimate (inverse_dynamics.h) beside a fit: another start where the
// fit is bad, and a second opinion where it is not.
#pragma once

#include <optional>
#include <vector>

#include "fit/estimate/inverse_dynamics.h"

namespace axisfit {

/// The outcome of a fit that began again from the inverse-dynamics estimate.
enum class InverseStart {
  not_tried,  ///< there was no reason to, or no such estimate
  no_better,  ///< the fit from the initial values was kept
  better,     ///< it was kept
};

/// Fits again, in one continuation from the inverse-dynamics estimate, if there is one, where the
/// fit of the job is not usable, its model would count as wrong (grade.h), or the estimate alone
/// has the lower cost. Keeps in `fit` the better of the two: the usable one, or that of lower cost;
/// and in `job` its noise, where that is estimated. Throws Interrupted.
InverseStart try_inverse_start(Job& job, FitResult& fit, const RunContext& context = {});

/// The estimate beside the fit of the same job.
struct SecondOpinion {
  InverseDynamics estimate;
  /// Places in its parameters of those that fit and estimate both determine, and where they differ
  /// by more than five of their standard errors together and by more than a tenth. Empty where the
  /// estimate is not exact, or leaves more than a tenth of the drive force unexplained.
  std::vector<std::size_t> contradictions;
};

std::optional<SecondOpinion> second_opinion(const Job& job, const FitResult& fit);

}  // namespace axisfit
