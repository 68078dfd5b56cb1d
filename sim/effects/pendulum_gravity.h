#pragma once

#include <cmath>

#include "sim/effects/slots.h"

namespace axisfit {

/// Gravity on a joint. Its position is an angle, a radian for a metre, and its force a torque:
///
///   F = -(G_s sin(y0) + G_c cos(y0)) = -m g l sin(y0 - q0)
///
/// with G_s = m g l cos(q0) and G_c = -m g l sin(q0); q0 is where the arm hangs at rest. So zero is
/// regular, and the angle need not be counted from below.
template <class T>
struct PendulumGravity {
  static constexpr std::string_view name = "pendulum_gravity";
  static constexpr std::string_view meaning = "gravity on a joint";
  static constexpr ActsOn acts_on = ActsOn::arm_force;
  static constexpr std::string_view excitation = "motion over a large part of a turn";

  T G_s, G_c;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"G_s", "N", "weight times lever, where zero hangs down", -1e5, 1e5}.typically(
              12.0),
          self.G_s);
    visit(
        Quantity{"G_c", "N", "weight times lever, where zero is level", -1e5, 1e5}.typically(-7.0),
        self.G_c);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    // Over less it is a constant force and a spring.
    constexpr double kLeastTurn = 0.5;  // rad
    const bool turns = scales.position_high - scales.position_low > kLeastTurn;
    return {{.strengths = {"G_s", "G_c"}, .settings = ShapeSettings(turns ? 1 : 0)}};
  }

  T arm_force(const Instant<T>& at) const {
    using std::cos, std::sin;
    return -(G_s * sin(at.position) + G_c * cos(at.position));
  }
};

}  // namespace axisfit
