#pragma once

#include <cmath>

#include "sim/effects/slots.h"

namespace axisfit {

/// Presliding hysteresis: after each reversal the friction builds up over a short travel, as the
/// asperities of the surfaces bend before they slip,
///
///   F = F_d z,  dz/dy0 = (direction - z) / l_d,
///
/// stiffness F_d / l_d at the reversal. Between two reversals z has a closed form in the travel
/// since the first of them, so that no fast state has to be integrated. It starts at z = 0.
///
/// Source: P. R. Dahl (1968); the friction of LuGre (Canudas de Wit et al., IEEE TAC 40, 1995)
/// without its damping and its Stribeck curve, which is an effect of its own.
template <class T>
struct DahlFriction {
  static constexpr std::string_view name = "dahl_friction";
  static constexpr std::string_view meaning = "friction that builds up over a short travel";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation =
      "many reversals, sampled more densely than friction builds up";

  T F_d, l_d;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_d", "N", "steady friction after a long travel", 0, 1e5}.typically(10.0),
          self.F_d);
    visit(Quantity{"l_d", "m", "travel over which it builds up", 1e-7, 1, kRequired,
                   UsedBy::every_axis, true}
              .typically(2e-4),
          self.l_d);
  }

  static std::vector<SearchEntry> search(const SearchScales&) {
    return {{{"F_d"}, {"l_d"}, geometric(1e-5, 1e-2, 4)}};
  }

  T hysteresis(const Instant<T>& at) const {
    using std::exp;
    const double s = at.direction;
    const T travel = s * (at.position - at.memory.position);
    return s == 0.0 ? at.memory.hysteresis : s - (s - at.memory.hysteresis) * exp(-travel / l_d);
  }

  T arm_force(const Instant<T>& at) const { return -(F_d * hysteresis(at)); }
};

}  // namespace axisfit
