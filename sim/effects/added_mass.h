#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// Mass on the arm beyond M: a payload, or, negative, a part that is missing.
template <class T>
struct AddedMass {
  static constexpr std::string_view name = "added_mass";
  static constexpr std::string_view meaning = "mass added to the arm";
  static constexpr ActsOn acts_on = ActsOn::inertia;
  static constexpr std::string_view excitation = motions::kAcceleration;

  T dM;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"dM", "kg", "mass added to the arm", -1e5, 1e5}.typically(8.0), self.dM);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"dM"}}}; }

  void add_to(Slots<T>& slots) const { slots.added_mass += dM; }
};

}  // namespace axisfit
