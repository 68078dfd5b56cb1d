// Counters that overflow: encoders of one turn, registers of so many bits.
#pragma once

#include <vector>

namespace axisfit {

/// Makes continuous what begins anew after `period`: every step is the shortest there is. The first
/// value stays; NaN is left out.
void unwrap(std::vector<double>& values, double period);

/// Signed integers of so many bits (2 to 52) that were stored without their sign: 65535 is -1
/// of 16.
void restore_sign(std::vector<double>& values, int bits);

}  // namespace axisfit
