// What simulators of rigid bodies know of an axis.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/rig.h"

namespace axisfit {

/// m y'' = K U + F_0 - k y - b y' - F_c sign y', with the unit of the joint; gravity turns with it.
struct RigidAxis {
  bool turns = false;
  double arm = 0.0;       ///< kg or kg m^2, of the arm
  double armature = 0.0;  ///< of the motor, as the arm feels it
  double damping = 0.0;   ///< N s/m, with that of the motor and of its back EMF
  double friction = 0.0;  ///< N, holds at rest
  double stiffness = 0.0;
  double gain = 1.0;  ///< N per unit of the command
  double force = 0.0;
  double lag = 0.0;                             ///< s, with which the force follows the command
  double gravity_sin = 0.0, gravity_cos = 0.0;  ///< N m: -(s sin y + c cos y)
};

/// What of an axis is left when all is left out but these effects.
struct Reduced {
  RigidAxis axis;
  Rig rig;                        ///< the same, for our own simulation
  std::vector<std::string> lost;  ///< a sentence each
};

/// Throws std::runtime_error for a velocity loop or a preamplifier: between command and motor there
/// is more than a gain and a lag.
Reduced reduced_to(const Rig& rig, const std::vector<std::string_view>& effects,
                   std::string_view target);

}  // namespace axisfit
