#pragma once

#include <cmath>

#include "sim/effects/slots.h"
#include "sim/scalar.h"

namespace axisfit {

/// Drag that grows with the square of the velocity, -c y1 |y1|: air, or churned lubricant. With an
/// exponent n of the speed it is -c y1 |y1| (|y1| / v_1)^(n - 2), where v_1 is 1 m/s (rad/s), so
/// that c is the drag at that speed: grease has less than two, and thins so far that n is below
/// one. A negative c beside B_a is a friction that bends down, as that of gear units that are
/// greased. Below two the last factor has no bound at rest. It is taken as
///
///   ((y1 / v_1)^2 + 0.001^2)^((n - 2) / 2)
///
/// which is one for n = 2, and differs by less than 1 % above 0.01 m/s. At n = 1 it is B_a.
template <class T>
struct QuadraticDrag {
  static constexpr std::string_view name = "quadratic_drag";
  static constexpr std::string_view meaning = "drag that grows with a power of the velocity";
  static constexpr ActsOn acts_on = ActsOn::arm_force;
  static constexpr std::string_view excitation = "motion up to the highest speed";

  T c, n{2.0};

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"c", "N s^2/m^2", "quadratic drag of the arm", -1e6, 1e6}.typically(60.0),
          self.c);
    visit(Quantity{"n", "1", "exponent of the speed", 0.3, 4, 2.0, UsedBy::every_axis, true}
              .typically(1.6),
          self.n);
  }

  static std::vector<SearchEntry> search(const SearchScales&) {
    return {{{"c"}}, {.strengths = {"n"}, .probes = {0.5, 1.6, 2.5}, .extends = name}};
  }

  T arm_force(const Instant<T>& at) const {
    using std::pow;
    constexpr double kRounded = 1e-3;
    const T square = at.velocity * at.velocity;
    T force = c * square;
    if (is_active(n - 2.0)) force *= pow(square + kRounded * kRounded, 0.5 * (n - 2.0));
    return at.velocity < 0.0 ? force : -force;
  }
};

}  // namespace axisfit
