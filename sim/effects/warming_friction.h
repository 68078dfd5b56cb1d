#pragma once

#include <algorithm>
#include <cmath>

#include "sim/effects/slots.h"

namespace axisfit {

/// Dry friction of a machine that is cold at first, as of seals that warm up in motion. At the time
/// t, from the zero of the recording's time, it adds F_w exp(-t / t_w) to all other dry friction,
/// at rest too; negative where friction grows instead. Grease is an effect of its own.
template <class T>
struct WarmingFriction {
  static constexpr std::string_view name = "warming_friction";
  static constexpr std::string_view meaning = "dry friction that fades with time";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation =
      "like motion throughout a recording in which friction settles";

  T F_w, t_w;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_w", "N", "dry friction at time zero minus that later", -1e5, 1e5}.typically(
              8.0),
          self.F_w);
    visit(Quantity{"t_w", "s", "time after which 1/e of it is left", 1e-3, 1e6, kRequired,
                   UsedBy::every_axis, true}
              .typically(0.8),
          self.t_w);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    const double duration = std::max(scales.end - scales.start, 1e-2);
    return {{.strengths = {"F_w"},
             .shapes = {"t_w"},
             .settings = geometric(0.1 * duration, duration, 2),
             .changes_dry_friction = true}};
  }

  T friction_curve(const Instant<T>& at) const {
    using std::exp;
    return F_w * exp(-at.time / t_w);
  }
};

}  // namespace axisfit
