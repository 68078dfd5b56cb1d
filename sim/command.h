// The input of the axis: a set-velocity voltage that is constant between switching instants.
#pragma once

#include <vector>

#include "base/samples.h"

namespace axisfit {

/// A piecewise constant command: `values[k]` (V) from `times[k]` (s) on, later by the delay T_d of
/// the axis. Before the first instant the command is zero.
struct Schedule {
  Samples times;  ///< increasing
  Samples values;

  void append(double time, double value) {
    times.edit().push_back(time);
    values.edit().push_back(value);
  }
};

/// The schedule of a command column: one entry wherever the value changes.
Schedule schedule_from_samples(const std::vector<double>& times, const std::vector<double>& values);

}  // namespace axisfit
