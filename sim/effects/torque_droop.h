#pragma once

#include "sim/effects/droop.h"
#include "sim/effects/slots.h"

namespace axisfit {

/// Torque constant that decreases with the current, K_m (1 / sqrt(1 + 2 c_q y6^2) - c_i |y6|):
/// saturated iron and armature reaction, see lost_part().
template <class T>
struct TorqueDroop {
  static constexpr std::string_view name = "torque_droop";
  static constexpr std::string_view meaning = "torque constant that falls with the current";
  static constexpr ActsOn acts_on = ActsOn::motor_torque;
  static constexpr std::string_view excitation = "accelerations from gentle to the current limit";

  T c_i, c_q;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"c_i", "1/A", "relative loss of K_m per ampere", -1, 1, 0.0,
                   UsedBy::motor_constant}
              .typically(0.01),
          self.c_i);
    visit(Quantity{"c_q", "1/A^2", "relative loss of K_m per square of the current", 0, 1, 0.0,
                   UsedBy::motor_constant}
              .typically(5e-5),
          self.c_q);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"c_i"}}, {{"c_q"}}}; }

  T motor_torque(const Instant<T>& at) const {
    return -(lost_part(c_i, c_q, at.current) * at.drive_torque);
  }
};

}  // namespace axisfit
