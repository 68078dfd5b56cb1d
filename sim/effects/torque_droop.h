#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// Torque constant that decreases with the current, K_m (1 - c_i |y6|): armature reaction and
/// saturated iron.
template <class T>
struct TorqueDroop {
  static constexpr std::string_view name = "torque_droop";
  static constexpr std::string_view meaning = "torque constant that falls with the current";
  static constexpr ActsOn acts_on = ActsOn::motor_torque;
  static constexpr std::string_view excitation = "accelerations from gentle to the current limit";

  T c_i;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"c_i", "1/A", "relative loss of K_m per ampere", -1, 1, kRequired,
                   UsedBy::motor_constant}
              .typically(0.01),
          self.c_i);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"c_i"}}}; }

  T motor_torque(const Instant<T>& at) const {
    const T loss = c_i * at.current * at.drive_torque;
    return at.current < 0.0 ? loss : -loss;
  }
};

}  // namespace axisfit
