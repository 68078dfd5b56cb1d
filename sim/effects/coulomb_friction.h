#pragma once

#include "sim/quantity.h"

namespace axisfit {

/// Dry friction of the arm with true sticking: it opposes the velocity with the force F_c, and at
/// rest holds against any force up to F_c.
///
/// Slot: friction_level, a force in newtons on the arm side that adds to the F_s of (6).
/// Source: C. A. de Coulomb (1785); at rest a Filippov problem like (6). Zero is a regular point.
template <class T>
struct CoulombFriction {
  static constexpr std::string_view name = "coulomb_friction";
  static constexpr std::string_view meaning = "Coulomb friction of the arm";

  T F_c;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_c", "N", "Coulomb friction of the arm", 0, 1e5}, self.F_c);
  }

  T friction_level() const { return F_c; }
};

}  // namespace axisfit
