// The term that ties a simulation to a measurement.
//
// It gives the fit its convergence (a simulation that follows the data cannot drift into a wrong
// minimum) and the diagnosis its missing force (the force that had to be added).
#pragma once

#include "sim/axis.h"

namespace axisfit {

/// How firmly the simulated axis is held to the measured one. All zero: free running.
struct Coupling {
  /// 1/s. y1' += velocity (v - y1), v the measured velocity of the arm.
  double velocity = 0.0;
  /// 1/s. The whole axis moves with the rate position * e, e = measured - simulated encoder
  /// position: y0' += position e, y2' += position e / r_g. The gear force is not disturbed.
  double position = 0.0;
  /// 1/s^2. y1' += acceleration e, y3' += acceleration e / r_g.
  double acceleration = 0.0;

  bool active() const { return velocity > 0.0 || position > 0.0 || acceleration > 0.0; }

  /// First order, bandwidth `rate` in 1/s, for a recorded velocity and, if recorded, position.
  static Coupling to_velocity(double rate, bool and_position) {
    return {rate, and_position ? rate : 0.0, 0.0};
  }
  /// Second order, critically damped, natural frequency `rate` in rad/s, for position alone.
  static Coupling to_position(double rate) { return {0.0, 2.0 * rate, rate * rate}; }
};

/// What the simulation is held to, at one instant: measured arm velocity m/s and encoder position
/// m.
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

}  // namespace axisfit
