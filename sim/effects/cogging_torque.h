#pragma once

#include <cmath>

#include "sim/effects/slots.h"

namespace axisfit {

/// Torque on the motor that is periodic in its angle and independent of the current: cogging of the
/// magnets, an eccentric pinion. `order` periods per turn.
///
///   T = T_s sin(order y2) + T_c cos(order y2)
template <class T>
struct CoggingTorque {
  static constexpr std::string_view name = "cogging_torque";
  static constexpr std::string_view meaning = "torque that is periodic in the motor angle";
  static constexpr ActsOn acts_on = ActsOn::motor_torque;
  static constexpr std::string_view excitation = motions::kManyTurns;

  T T_s, T_c, order;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    using enum UsedBy;
    visit(Quantity{"T_s", "N m", "sine coefficient", -1e3, 1e3, kRequired, motor}.typically(0.05),
          self.T_s);
    visit(
        Quantity{"T_c", "N m", "cosine coefficient", -1e3, 1e3, kRequired, motor}.typically(-0.03),
        self.T_c);
    visit(Quantity{"order", "1", "periods per motor revolution", 0.01, 1e3, kRequired, motor, true}
              .typically(3.0),
          self.order);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    return {{.strengths = {"T_s", "T_c"},
             .shapes = {"order"},
             .settings = orders_per_turn(scales.periods, scales.pinion_radius),
             .has_phase = true}};
  }

  T motor_torque(const Instant<T>& at) const {
    using std::cos, std::sin;
    const T q = order * at.motor_angle;
    return T_s * sin(q) + T_c * cos(q);
  }
};

}  // namespace axisfit
