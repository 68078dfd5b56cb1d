// Likelihood profiles: the deviance with one parameter fixed away from its estimate and all others
// refitted.
#pragma once

#include <functional>
#include <span>

#include "fit/estimate/estimate.h"

namespace axisfit {

struct ProfilePoint {
  double value = 0.0;     ///< of the parameter, in its unit
  double deviance = 0.0;  ///< of the best fit with the parameter there, see Profile
};

/// One end of an interval.
struct ProfileEnd {
  double value = 0.0;  ///< in the parameter's unit
  /// The deviance stays below the threshold up to the parameter's bound, which `value` is then, or
  /// for as far as the simulation finishes.
  bool open = false;
};

/// The profile of one parameter. Its deviance is what -2 log likelihood grows by over that of the
/// estimate, in units of the parameter's variance over what white noise of the stated size would
/// give it: a likelihood that knows of the residuals' size and colour only as the standard errors
/// do. The interval ends where it reaches the square of Student's quantile.
///
/// Literature: D. M. Bates and D. G. Watts, Nonlinear Regression Analysis and its Applications,
/// Wiley 1988, chapter 6; the scale of the deviance: R. E. Chandler and S. Bate, Biometrika 94
/// (2007).
struct Profile {
  std::size_t parameter = 0;
  std::vector<ProfilePoint> points;  ///< by value, the estimate among them
  double threshold = 0.0;
  ProfileEnd lower, upper;
  /// The best fit found while profiling, if it is better than the one being profiled.
  std::optional<StartResult> better;
};

/// Profiles of some parameters of a usable fit of the job: from the estimate outwards to either
/// side, with all other parameters refitted at every point. Sides are independent of each other,
/// and spread over the job's threads. `progress` is called with the number of sides done and of all
/// sides.
std::vector<Profile> profiles(const Job& job, const FitResult& fit,
                              std::span<const std::size_t> parameters,
                              const RunContext& context = {});

}  // namespace axisfit
