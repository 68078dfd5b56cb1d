#pragma once

#include <algorithm>
#include <cmath>

#include "sim/effects/slots.h"

namespace axisfit {

/// Friction that changes with the distance s that the arm has travelled, both ways together: a film
/// that spreads, a surface that runs in, a wiper that clears a guide after standstill. It adds
/// F_r exp(-s / l_r) to all other dry friction, at rest too; negative where friction grows instead.
/// The distance counts from the start of the simulation. Under dry friction that hardly changes it
/// is in proportion to the work done.
template <class T>
struct RunningInFriction {
  static constexpr std::string_view name = "running_in_friction";
  static constexpr std::string_view meaning = "friction that fades with the distance travelled";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation =
      "like motion throughout a recording, with rests, in which friction settles";

  T F_r, l_r;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_r", "N", "dry friction at the start minus that later", -1e5, 1e5}.typically(
              8.0),
          self.F_r);
    visit(Quantity{"l_r", "m", "distance after which 1/e of it is left", 1e-5, 1e6, kRequired,
                   UsedBy::every_axis, true}
              .typically(0.15),
          self.l_r);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    const double stroke = std::max(scales.position_high - scales.position_low, 1e-3);
    return {{.strengths = {"F_r"},
             .shapes = {"l_r"},
             .settings = geometric(0.3 * stroke, 3.0 * stroke, 2),
             .changes_dry_friction = true}};
  }

  /// The distance travelled, m, which is no hysteresis but is remembered as one.
  T hysteresis(const Instant<T>& at) const {
    return at.memory.hysteresis + double(at.direction) * (at.position - at.memory.position);
  }

  T friction_curve(const Instant<T>& at) const {
    using std::exp;
    return F_r * exp(-hysteresis(at) / l_r);
  }
};

}  // namespace axisfit
