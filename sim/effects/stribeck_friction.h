#pragma once

#include <cmath>

#include "sim/effects/slots.h"
#include "sim/scalar.h"

namespace axisfit {

/// Dry friction that changes at low speed: F_st exp(-|y1| / v_st) in addition to all other dry
/// friction, also at standstill. Positive for the Stribeck effect, where a lubricating film builds
/// up with speed; negative where friction is lower at low speed. With an exponent n it is
/// F_st exp(-x^n), x = |y1| / v_st: of 1/2 where the film builds up early, of 2 a Gaussian. At rest
/// x^n has no slope but for n = 1, or one that no step could follow. It is taken as
///
///   x (x^2 + 0.01^2)^((n - 1) / 2)
///
/// which is x for n = 1, and differs from x^n by less than 0.5 % above a tenth of v_st up to n = 2.
///
/// Source: R. Stribeck (1902); the exponential form is that of A. Tustin (1947), see B.
/// Armstrong-Helouvry et al., Automatica 30 (1994), with exponents from 1/2 to 2.
template <class T>
struct StribeckFriction {
  static constexpr std::string_view name = "stribeck_friction";
  static constexpr std::string_view meaning = "friction that is higher (or lower) at low speed";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation = "slow motion, and speeds well above it";

  T F_st, v_st, n{1.0};

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_st", "N", "dry friction at low speed minus that at high speed", -1e5, 1e5}
              .typically(12.0),
          self.F_st);
    visit(Quantity{"v_st", "m/s", "speed at which it has fallen to 1/e", 1e-4, 10, kRequired,
                   UsedBy::every_axis, true}
              .typically(0.05),
          self.v_st);
    visit(Quantity{"n", "1", "exponent of the speed", 0.25, 4, 1.0, UsedBy::every_axis, true}
              .typically(1.4),
          self.n);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    const double speed = std::max(scales.speed, 1e-3);
    // Tustin's law and the Gaussian: the best of one is no start for the other.
    ShapeSettings settings;
    for (const double exponent : {1.0, 2.0})
      for (std::vector<double> setting : geometric(0.003 * speed, 0.3 * speed, 5)) {
        setting.push_back(exponent);
        settings.push_back(setting);
      }
    return {{{"F_st"}, {"v_st"}, settings, {"n"}},
            {.strengths = {"n"}, .probes = {0.7, 1.5}, .extends = name}};
  }

  T friction_curve(const Instant<T>& at) const {
    using std::exp, std::pow;
    constexpr double kRounded = 0.01;
    T x = double(at.direction) * at.velocity / v_st;
    if (is_active(n - 1.0)) x *= pow(x * x + kRounded * kRounded, 0.5 * (n - 1.0));
    return F_st * exp(-x);
  }
};

}  // namespace axisfit
