// What the jobs of several axes of one machine say together of their couplings.
#pragma once

#include <string>
#include <vector>

#include "fit/run.h"

namespace axisfit {

/// The run of one axis.
struct AxisRun {
  std::string name;
  RunResult result;
};

/// A value with its standard error.
struct Estimated {
  double value = 0.0, error = 0.0;
};

/// Inertia that two axes share acts on both alike: with the kinetic energy m y1 z1 each is pushed
/// by -m times the acceleration of the other. Each of their fits tells it, from other samples.
struct SharedInertia {
  std::string one, other;  ///< axes
  std::string unit;        ///< kg; kg m of a joint and a slide, kg m^2 of two joints
  Estimated from_one, from_other, both;
  double apart = 0.0;  ///< difference of the two over its standard error
};

/// Of all pairs of axes where each has a determined force in proportion to the acceleration of the
/// other: a channel called by the other's name with "_acceleration", as "y_acceleration". `both` is
/// the mean of the two, weighted by their variances, which is what one fit of both axes would give;
/// its error is widened where they disagree.
std::vector<SharedInertia> shared_inertias(const std::vector<AxisRun>& axes);

}  // namespace axisfit
