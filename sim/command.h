// The input of the axis, as it was commanded or measured: what its drive takes, or a position that
// its controller follows.
#pragma once

#include <cstddef>
#include <vector>

#include "base/samples.h"

namespace axisfit {

/// What the input does between two of its values.
enum class Hold {
  zero_order,  ///< keeps the first: as what is commanded
  linear,      ///< goes straight to the second: as what is measured
};

/// What the values are.
enum class Meaning {
  command,    ///< of the drive, in its unit
  reference,  ///< position that the controller shall reach, m
};

/// A command of `values[k]` from `times[k]` (s) on, later by the dead time T_d of the axis.
/// Before the first instant it is zero, or if linear the first value; behind the last, the last.
struct Schedule {
  Samples times;  ///< increasing
  Samples values;
  Hold hold = Hold::zero_order;
  Meaning meaning = Meaning::command;

  void append(double time, double value) {
    times.edit().push_back(time);
    values.edit().push_back(value);
  }
  /// What acts at a time, s, without dead time.
  double value_at(double time) const;
  /// V/s, from the instant k to the next one.
  double slope_after(std::size_t k) const {
    if (hold == Hold::zero_order || k + 1 >= times.size()) return 0.0;
    return (values[k + 1] - values[k]) / (times[k + 1] - times[k]);
  }
};

/// The schedule of a command column: one entry wherever the value changes; if linear, but for the
/// inner ones of three that are equal.
Schedule schedule_from_samples(const std::vector<double>& times, const std::vector<double>& values,
                               Hold hold = Hold::zero_order);

}  // namespace axisfit
