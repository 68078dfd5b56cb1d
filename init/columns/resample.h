// The values of one clock at the times of another.
#pragma once

#include <vector>

namespace axisfit {

/// Each value of a clock until its next, `offset` s after its time; before the first one it is
/// that. Values that are NaN, or stand at a time that is, are left out; empty where none are left.
std::vector<double> held_at(const std::vector<double>& times, const std::vector<double>& clock,
                            const std::vector<double>& values, double offset = 0.0);

/// The same, but straight between the values, and constant beyond.
std::vector<double> interpolated_at(const std::vector<double>& times,
                                    const std::vector<double>& clock,
                                    const std::vector<double>& values);

}  // namespace axisfit
