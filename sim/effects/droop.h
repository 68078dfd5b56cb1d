#pragma once

#include <cmath>

#include "sim/scalar.h"

namespace axisfit {

/// The part of its force that a drive loses at x, its force or current:
///
///   c |x| + 1 - 1 / sqrt(1 + 2 c_q x^2)
///
/// What a resistance takes is proportional to x. Iron that saturates is straight at first, loses
/// c_q x^2, and gives no more than x does at 1 / sqrt(2 c_q).
template <class T>
T lost_part(const T& c, const T& c_q, const T& x) {
  using std::sqrt;
  T lost = c * x;
  if (x < 0.0) lost = -lost;
  if (is_active(c_q)) lost += 1.0 - 1.0 / sqrt(1.0 + 2.0 * c_q * x * x);
  return lost;
}

}  // namespace axisfit
