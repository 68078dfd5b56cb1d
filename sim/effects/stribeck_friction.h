#pragma once

#include <cmath>

#include "sim/effects/slots.h"

namespace axisfit {

/// Dry friction that changes at low speed: F_st exp(-|y1| / v_st) in addition to all other dry
/// friction, also at standstill. Positive for the Stribeck effect, where a lubricating film builds
/// up with speed; negative where friction is lower at low speed.
///
/// Source: R. Stribeck (1902); the exponential form is that of A. Tustin (1947), see B.
/// Armstrong-Helouvry et al., Automatica 30 (1994).
template <class T>
struct StribeckFriction {
  static constexpr std::string_view name = "stribeck_friction";
  static constexpr std::string_view meaning = "friction that is higher (or lower) at low speed";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation = "slow motion, and speeds well above it";

  T F_st, v_st;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_st", "N", "dry friction at low speed minus that at high speed", -1e5, 1e5}
              .typically(12.0),
          self.F_st);
    visit(Quantity{"v_st", "m/s", "speed at which it has fallen to 1/e", 1e-4, 10, kRequired,
                   UsedBy::every_axis, true}
              .typically(0.05),
          self.v_st);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    const double speed = std::max(scales.speed, 1e-3);
    return {{{"F_st"}, {"v_st"}, geometric(0.003 * speed, 0.3 * speed, 5)}};
  }

  T friction_curve(const Instant<T>& at) const {
    using std::exp;
    return F_st * exp(-double(at.direction) * at.velocity / v_st);
  }
};

}  // namespace axisfit
