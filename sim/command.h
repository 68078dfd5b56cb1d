// The input of the axis: a set-velocity voltage that is constant between switching instants.
#pragma once

#include <vector>

namespace axisfit {

/// A piecewise constant command: `values[k]` (V) from `times[k]` (s) on, later by the delay T_d of
/// the axis. Before the first instant the command is zero.
struct Schedule {
  std::vector<double> times;  ///< increasing
  std::vector<double> values;
};

/// The schedule of a command column: one entry wherever the value changes.
Schedule schedule_from_samples(const std::vector<double>& times, const std::vector<double>& values);

}  // namespace axisfit
