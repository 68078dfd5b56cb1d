#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// A constant force on the arm: gravity on a vertical axis (-M g, when positive is up), or the
/// offset of a drive.
template <class T>
struct ConstantForce {
  static constexpr std::string_view name = "constant_force";
  static constexpr std::string_view meaning = "constant force on the arm";
  static constexpr ActsOn acts_on = ActsOn::arm_force;
  static constexpr std::string_view excitation = motions::kBothWays;

  T F_0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_0", "N", "constant force on the arm", -1e5, 1e5}.typically(-8.0), self.F_0);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"F_0"}}}; }

  void add_to(Slots<T>& slots) const { slots.constant_force += F_0; }
};

}  // namespace axisfit
