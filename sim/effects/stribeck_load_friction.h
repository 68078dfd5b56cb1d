#pragma once

#include <cmath>

#include "sim/effects/slots.h"

namespace axisfit {

/// Dry friction in proportion to the force f that the gear transmits, as in LoadFriction, which
/// falls with speed: mu_st f exp(-|y1| / v_l), also at standstill.
///
/// Source: M. Duclusaud, G. Passault, V. Padois and O. Ly, Extended friction models for the physics
/// simulation of servo actuators, ICRA 2025, with the exponent one.
template <class T>
struct StribeckLoadFriction {
  static constexpr std::string_view name = "stribeck_load_friction";
  static constexpr std::string_view meaning =
      "friction proportional to the transmitted force at low speed";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation =
      "slow motion under loads of several sizes, and faster motion";

  T mu_st, v_l;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(
        Quantity{"mu_st", "1", "dry friction per transmitted force at low speed", -1, 1}.typically(
            0.06),
        self.mu_st);
    visit(Quantity{"v_l", "m/s", "speed at which it has fallen to 1/e", 1e-4, 100, kRequired,
                   UsedBy::every_axis, true}
              .typically(0.05),
          self.v_l);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    const double speed = std::max(scales.speed, 1e-3);
    return {{{"mu_st"}, {"v_l"}, geometric(0.01 * speed, 0.3 * speed, 3)}};
  }

  void add_to(Slots<T>& slots) const { slots.load_curve += mu_st; }
  T friction_curve(const Instant<T>& at) const {
    using std::exp;
    return mu_st * at.load * exp(-double(at.direction) * at.velocity / v_l);
  }
};

}  // namespace axisfit
