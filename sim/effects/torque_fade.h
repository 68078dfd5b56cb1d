#pragma once

#include <algorithm>
#include <cmath>

#include "sim/effects/slots.h"
#include "sim/scalar.h"

namespace axisfit {

/// Torque that fades as the motor warms up, K_m / (1 + loss), with t from the zero of the
/// recording's time and
///
///   loss = c_t (1 - exp(-a_t t)) / a_t,   which is c_t t for a_t = 0:
///
/// a_t is the reciprocal of the motor's thermal time constant, zero where the recording is short
/// against that. Heat that depends on the motion is none of it: the load is taken to be even.
template <class T>
struct TorqueFade {
  static constexpr std::string_view name = "torque_fade";
  static constexpr std::string_view meaning = "torque that fades with time";
  static constexpr ActsOn acts_on = ActsOn::motor_torque;
  static constexpr std::string_view excitation = "a recording long enough for the motor to warm up";

  T c_t, a_t{0.0};

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(
        Quantity{"c_t", "1/s", "initial relative loss of K_m per second", -0.1, 10}.typically(0.1),
        self.c_t);
    visit(Quantity{"a_t", "1/s", "reciprocal of the thermal time constant", 0, 100, 0.0,
                   UsedBy::every_axis, true}
              .typically(0.4),
          self.a_t);
  }

  /// Straight, and with a time constant.
  static std::vector<SearchEntry> search(const SearchScales& scales) {
    const double duration = std::max(scales.end - scales.start, 1e-2);
    return {{{"c_t"}}, {{"c_t"}, {"a_t"}, geometric(0.3 / duration, 10.0 / duration, 4)}};
  }

  T motor_torque(const Instant<T>& at) const {
    const T loss = c_t * at.time * mean_decay(a_t * at.time);
    return -(loss / (1.0 + loss) * at.drive_torque);
  }

 private:
  /// (1 - exp(-x)) / x, the mean of exp(-x) from zero on.
  static T mean_decay(const T& x) {
    using std::exp;
    if (!is_active(x)) return T(1.0);
    constexpr double kSmall = 0.01;  // where the series is exact to rounding
    if (std::abs(value_of(x)) < kSmall)
      return 1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0))));
    return (1.0 - exp(-x)) / x;
  }
};

}  // namespace axisfit
