#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// Dry friction that grows with the square of the force that the gear transmits, mu_q f^2; for a
/// rigid transmission f is the drive's force. Positive where teeth or nuts bend and rub on more of
/// their flanks, negative where load_friction levels off.
///
/// Source: the quadratic term of M. Duclusaud, G. Passault, V. Padois and O. Ly, Extended friction
/// models for the physics simulation of servo actuators, ICRA 2025, without its Stribeck factor.
template <class T>
struct QuadraticLoadFriction {
  static constexpr std::string_view name = "quadratic_load_friction";
  static constexpr std::string_view meaning =
      "friction that grows with the transmitted force squared";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation = motions::kAcceleration;

  T mu_q;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"mu_q", "1/N", "dry friction per square of the transmitted force", -1, 1}
              .typically(2e-4),
          self.mu_q);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"mu_q"}}}; }

  T friction_curve(const Instant<T>& at) const { return mu_q * at.load * at.load; }
};

}  // namespace axisfit
