// The observer: a correction term that makes a simulation track a measurement.
//
// The fit converges because of it (a simulation that tracks the data cannot drift into a wrong
// minimum), and it measures the missing force (the force that it adds).
#pragma once

#include <span>
#include <vector>

#include "sim/axis.h"

namespace axisfit {

/// The gains of the observer. All zero: free-running.
struct Observer {
  /// 1/s. y1' += velocity (v - y1), v the measured velocity of the arm.
  double velocity = 0.0;
  /// 1/s. The whole axis moves with the rate position * e, e = measured - simulated encoder
  /// position: y0' += position e, y2' += position e / r_g. The gear force is not disturbed.
  double position = 0.0;
  /// 1/s^2. y1' += acceleration e, y3' += acceleration e / r_g.
  double acceleration = 0.0;

  bool active() const { return velocity > 0.0 || position > 0.0 || acceleration > 0.0; }

  /// First order, bandwidth `rate` in 1/s, for a recorded velocity and, if recorded, position.
  static Observer of_velocity(double rate, bool and_position) {
    return {rate, and_position ? rate : 0.0, 0.0};
  }
  /// Second order, critically damped, natural frequency `rate` in rad/s, for position alone.
  static Observer of_position(double rate) { return {0.0, 2.0 * rate, rate * rate}; }
};

/// The target of the observer at one instant: measured arm velocity m/s and encoder position m.
template <class T>
struct TargetOf {
  T velocity{0.0};
  T position{0.0};

  /// Moves along the rate `slope` per second for `length` seconds.
  template <class U>
  void move(const TargetOf<double>& slope, const U& length) {
    velocity += slope.velocity * length;
    position += slope.position * length;
  }
};
using Target = TargetOf<double>;

/// The corners of a target that runs linearly between samples of a smooth curve f at these times
/// (s, increasing), and that is right in the mean.
///
/// The chord over an interval h is off by f'' h^2 / 12 on average, towards the inside of the curve:
/// a simulation that tracks chords at a high gain accelerates like a lighter arm. Weighted by a hat
/// over the two intervals beside a sample, h1 and h2, chords are off by f'' (h1^3 + h2^3) / 24, and
/// corners that are lower by d by d (h1 + h2) / 2. So d = f'' (h1^2 - h1 h2 + h2^2) / 12, with f''
/// from divided differences: for even sampling a twelfth of the second difference.
std::vector<double> target_corners(std::span<const double> times, std::span<const double> values);

}  // namespace axisfit
