#pragma once

#include <cmath>

#include "sim/effects/slots.h"

namespace axisfit {

/// Ripple of the torque constant in the motor angle: commutation, winding. `order` periods per
/// turn.
///
///   K_m (1 + r_s sin(order y2) + r_c cos(order y2))
template <class T>
struct TorqueRipple {
  static constexpr std::string_view name = "torque_ripple";
  static constexpr std::string_view meaning = "torque constant that varies with the motor angle";
  static constexpr ActsOn acts_on = ActsOn::motor_torque;
  static constexpr std::string_view excitation = "high current over many turns of the motor";

  T r_s, r_c, order;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    using enum UsedBy;
    visit(
        Quantity{"r_s", "1", "sine coefficient, relative to K_m", -1, 1, kRequired, motor_constant}
            .typically(0.03),
        self.r_s);
    visit(Quantity{"r_c", "1", "cosine coefficient, relative to K_m", -1, 1, kRequired,
                   motor_constant}
              .typically(-0.02),
          self.r_c);
    visit(Quantity{"order", "1", "periods per motor revolution", 0.01, 1e3, kRequired,
                   motor_constant, true}
              .typically(2.0),
          self.order);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    return {{.strengths = {"r_s", "r_c"},
             .shapes = {"order"},
             .settings = orders_per_turn(scales.drive_periods, scales.pinion_radius),
             .has_phase = true}};
  }

  T motor_torque(const Instant<T>& at) const {
    using std::cos, std::sin;
    const T q = order * at.motor_angle;
    return (r_s * sin(q) + r_c * cos(q)) * at.drive_torque;
  }
};

}  // namespace axisfit
