#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// Friction that changes along the stroke, as on a guide that is bent or tightened unevenly: the
/// dry friction by G_c y0 + G_q y0^2, the viscous coefficient by G_b y0.
template <class T>
struct PositionFriction {
  static constexpr std::string_view name = "position_friction";
  static constexpr std::string_view meaning = "friction that depends on the position";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation = motions::kWholeStroke;

  T G_c, G_q, G_b;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(
        Quantity{"G_c", "N/m", "slope of dry friction along the stroke", -1e6, 1e6, 0.0}.typically(
            60.0),
        self.G_c);
    visit(Quantity{"G_q", "N/m^2", "quadratic coefficient of dry friction along the stroke", -1e6,
                   1e6, 0.0}
              .typically(40.0),
          self.G_q);
    visit(Quantity{"G_b", "N s/m^2", "slope of viscous friction along the stroke", -1e6, 1e6, 0.0}
              .typically(300.0),
          self.G_b);
  }

  static std::vector<SearchEntry> search(const SearchScales&) {
    return {{{"G_c"}}, {{"G_q"}}, {{"G_c", "G_q"}}, {{"G_b"}}};
  }

  void add_to(Slots<T>& slots) const { slots.friction_slope += G_c; }
  T friction_curve(const Instant<T>& at) const { return G_q * at.position * at.position; }
  T arm_force(const Instant<T>& at) const { return -(G_b * at.position * at.velocity); }
};

}  // namespace axisfit
