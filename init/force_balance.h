// A first guess of a single mass with friction, straight from a recording, without simulating.
#pragma once

#include <optional>
#include <span>

namespace axisfit {

/// M dv/dt + B v + F_c sign(v) + F_0 + G_s sin(y) + G_c cos(y) = force. Units follow from those of
/// the input: with a force in newtons kg, N s/m and N.
struct ForceBalance {
  double mass = 0.0;
  double viscous = 0.0;
  double coulomb = 0.0;
  double constant = 0.0;     ///< what the drive has to bear at rest
  double correlation = 0.0;  ///< of the impulses with those of the force, -1 to 1
  double gravity_sine = 0.0, gravity_cosine = 0.0;  ///< of a joint, where that was asked for
};

/// Least squares over the impulses in short stretches of a recording: each term integrated, so that
/// nothing has to be differentiated twice. From a recorded position (m), or where it is empty from
/// a velocity (m/s). Good to an order of magnitude where the recording has acceleration and speeds
/// of both signs; nothing where it does not determine the four. Where the drive acts against the
/// motion, mass and correlation come out negative. With gravity the position is an angle, rad.
std::optional<ForceBalance> force_balance(std::span<const double> times,
                                          std::span<const double> position,
                                          std::span<const double> velocity,
                                          std::span<const double> force, bool with_gravity = false);

}  // namespace axisfit
