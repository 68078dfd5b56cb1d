#pragma once

#include <algorithm>

#include "sim/effects/slots.h"
#include "sim/scalar.h"

namespace axisfit {

/// Buffers at the ends of the stroke, which the arm meets within the recorded motion. Beyond y_h,
/// and before y_l, the arm is p deep in a buffer that pushes it back with
///
///   k p^2 (1 + d_e p'),   and never pulls,
///
/// a progressive spring that takes energy: K. H. Hunt and F. R. E. Crossley, "Coefficient of
/// restitution interpreted as damping in vibroimpact", Journal of Applied Mechanics 42 (1975). The
/// force and its slope begin at zero, so that it is smooth.
template <class T>
struct EndStops {
  static constexpr std::string_view name = "end_stops";
  static constexpr std::string_view meaning = "buffers at the ends of the stroke";
  static constexpr ActsOn acts_on = ActsOn::arm_force;
  static constexpr std::string_view excitation = "motion that meets an end of the stroke";

  T k_h, y_h, k_l, y_l, d_e;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"k_h", "N/m^2", "stiffness of the upper buffer", 0, 1e12, 0.0}.typically(2e4),
          self.k_h);
    visit(place("y_h", "position where the upper buffer begins").typically(0.02), self.y_h);
    visit(Quantity{"k_l", "N/m^2", "stiffness of the lower buffer", 0, 1e12, 0.0}.typically(3e4),
          self.k_l);
    visit(place("y_l", "position where the lower buffer begins").typically(0.01), self.y_l);
    visit(Quantity{"d_e", "s/m", "damping of the buffers", 0, 1e3, 0.0, UsedBy::every_axis, true}
              .typically(0.5),
          self.d_e);
  }

  /// One buffer at a time, begun near where the motion ends.
  static std::vector<SearchEntry> search(const SearchScales& scales) {
    const double stroke = std::max(scales.position_high - scales.position_low, 1e-3);
    ShapeSettings high, low;
    for (const double part : {0.01, 0.04, 0.12}) {
      high.push_back({scales.position_high - part * stroke});
      low.push_back({scales.position_low + part * stroke});
    }
    return {{{"k_h"}, {"y_h"}, high}, {{"k_l"}, {"y_l"}, low}};
  }

  T arm_force(const Instant<T>& at) const {
    return push(k_l, y_l - at.position, -at.velocity) - push(k_h, at.position - y_h, at.velocity);
  }

 private:
  static constexpr Quantity place(std::string_view symbol, std::string_view what) {
    return {symbol, "m", what, -1e3, 1e3, 0.0, UsedBy::every_axis, true};
  }

  /// Of a buffer that the arm is so deep in, and goes deeper at this speed.
  T push(const T& stiffness, const T& depth, const T& speed) const {
    if (!(value_of(depth) > 0.0) || !is_active(stiffness)) return T(0.0);
    const T factor = 1.0 + d_e * speed;
    return value_of(factor) > 0.0 ? stiffness * depth * depth * factor : T(0.0);
  }
};

}  // namespace axisfit
