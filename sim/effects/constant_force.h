#pragma once

#include "sim/quantity.h"

namespace axisfit {

/// A force on the arm that never changes: gravity on a vertical axis (-M g, when positive is up),
/// or the offset of a drive.
///
/// Slot: constant_force, newtons on the arm side, positive in the arm's positive direction.
template <class T>
struct ConstantForce {
  static constexpr std::string_view name = "constant_force";
  static constexpr std::string_view meaning = "constant force on the arm";

  T F_0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_0", "N", "constant force on the arm", -1e5, 1e5}, self.F_0);
  }

  T constant_force() const { return F_0; }
};

}  // namespace axisfit
