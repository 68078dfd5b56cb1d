#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// Torque that fades as the motor warms up, K_m / (1 + c_t t), t from the zero of the recording's
/// time. For a recording that is short against the motor's thermal time constant.
template <class T>
struct TorqueFade {
  static constexpr std::string_view name = "torque_fade";
  static constexpr std::string_view meaning = "torque that fades with time";
  static constexpr ActsOn acts_on = ActsOn::motor_torque;
  static constexpr std::string_view excitation = "a recording long enough for the motor to warm up";

  T c_t;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(
        Quantity{"c_t", "1/s", "initial relative loss of K_m per second", -0.1, 10}.typically(0.1),
        self.c_t);
  }

  static std::vector<SearchEntry> search(const SearchScales&) { return {{{"c_t"}}}; }

  T motor_torque(const Instant<T>& at) const {
    const T loss = c_t * at.time;
    return -(loss / (1.0 + loss) * at.drive_torque);
  }
};

}  // namespace axisfit
