#pragma once

#include "sim/axis.h"
#include "sim/quantity.h"

namespace axisfit {

/// Drag that grows with the square of the velocity, -c y1 |y1|: air, or a lubricant that is
/// churned.
///
/// Slot: arm_force, newtons on the arm side, a smooth function of the state that is not linear and
/// so goes through the Runge-Kutta part of the integrator.
template <class T>
struct QuadraticDrag {
  static constexpr std::string_view name = "quadratic_drag";
  static constexpr std::string_view meaning = "drag that grows with the square of the velocity";

  T c;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"c", "N s^2/m^2", "quadratic drag of the arm", 0, 1e6}, self.c);
  }

  T arm_force(const State<T>& y) const {
    const T& y1 = y[1];
    return y1 < 0.0 ? c * y1 * y1 : -(c * y1 * y1);
  }
};

}  // namespace axisfit
