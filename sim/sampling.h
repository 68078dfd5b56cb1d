// Instants of samples.
#pragma once

#include <span>

namespace axisfit {

/// s; beside the times themselves, shorter steps are rounding.
inline constexpr double kShortestStep = 1e-9;

/// Mean interval between two of at least two increasing instants, in their unit.
inline double mean_interval(std::span<const double> times) {
  return (times.back() - times.front()) / static_cast<double>(times.size() - 1);
}

}  // namespace axisfit
