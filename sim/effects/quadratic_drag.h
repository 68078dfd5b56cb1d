#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// Drag that grows with the square of the velocity, -c y1 |y1|: air, or churned lubricant.
template <class T>
struct QuadraticDrag {
  static constexpr std::string_view name = "quadratic_drag";
  static constexpr std::string_view meaning = "drag that grows with the square of the velocity";
  static constexpr ActsOn acts_on = ActsOn::arm_force;
  static constexpr std::string_view excitation = "motion up to the highest speed";

  T c;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"c", "N s^2/m^2", "quadratic drag of the arm", 0, 1e6}.typically(60.0), self.c);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"c"}}}; }

  T arm_force(const Instant<T>& at) const {
    const T force = c * at.velocity * at.velocity;
    return at.velocity < 0.0 ? force : -force;
  }
};

}  // namespace axisfit
