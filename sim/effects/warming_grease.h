#pragma once

#include <algorithm>
#include <cmath>

#include "sim/effects/slots.h"

namespace axisfit {

/// Viscous friction of a machine that is cold at first: grease that warms up in motion. At the time
/// t, from the zero of the recording's time, it adds B_w exp(-t / t_b) to B_a; negative where
/// friction grows instead. Dry friction has a time constant of its own: WarmingFriction.
template <class T>
struct WarmingGrease {
  static constexpr std::string_view name = "warming_grease";
  static constexpr std::string_view meaning = "viscous friction that fades with time";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation =
      "fast motion throughout a recording in which friction settles";

  T B_w, t_b;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"B_w", "N s/m", "viscous friction at time zero minus that later", -1e6, 1e6}
              .typically(30.0),
          self.B_w);
    visit(Quantity{"t_b", "s", "time after which 1/e of it is left", 1e-3, 1e6, kRequired,
                   UsedBy::every_axis, true}
              .typically(0.8),
          self.t_b);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    const double duration = std::max(scales.end - scales.start, 1e-2);
    return {{{"B_w"}, {"t_b"}, geometric(0.1 * duration, duration, 2)}};
  }

  T arm_force(const Instant<T>& at) const {
    using std::exp;
    return -(B_w * exp(-at.time / t_b) * at.velocity);
  }
};

}  // namespace axisfit
