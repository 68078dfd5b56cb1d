#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// Dry friction of the arm with true sticking: it opposes the velocity with the force F_c, and at
/// standstill holds against any force up to F_c.
///
/// Source: C. A. de Coulomb (1785); at standstill a Filippov problem like (6).
template <class T>
struct CoulombFriction {
  static constexpr std::string_view name = "coulomb_friction";
  static constexpr std::string_view meaning = "Coulomb friction of the arm";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation = motions::kBothWays;

  T F_c;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_c", "N", "Coulomb friction of the arm", 0, 1e5}.typically(15.0), self.F_c);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"F_c"}}}; }

  void add_to(Slots<T>& slots) const { slots.friction_level += F_c; }
};

}  // namespace axisfit
