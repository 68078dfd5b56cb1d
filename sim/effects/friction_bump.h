#pragma once

#include <algorithm>
#include <cmath>

#include "sim/effects/slots.h"

namespace axisfit {

/// Dry friction that is higher at one place of the stroke: a dent, a joint or a dry spot of a
/// guide, a seal that it passes. At the place y0 it adds F_b exp(-((y0 - y_b) / w_b)^2) to all
/// other dry friction, at rest too.
template <class T>
struct FrictionBump {
  static constexpr std::string_view name = "friction_bump";
  static constexpr std::string_view meaning = "friction that is higher at one place of the stroke";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation = motions::kWholeStroke;

  T F_b, y_b, w_b;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_b", "N", "dry friction in the middle of the bump", 0, 1e5}.typically(12.0),
          self.F_b);
    visit(Quantity{"y_b", "m", "position of its middle", -1e3, 1e3, kRequired, UsedBy::every_axis,
                   true}
              .typically(0.02),
          self.y_b);
    visit(Quantity{"w_b", "m", "distance from there at which it has fallen to 1/e", 1e-5, 1e3,
                   kRequired, UsedBy::every_axis, true}
              .typically(0.02),
          self.w_b);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    constexpr int kPlaces = 6;
    const double stroke = std::max(scales.position_high - scales.position_low, 1e-3);
    ShapeSettings settings;
    for (int place = 0; place < kPlaces; ++place)
      for (const double width : {stroke / 20.0, stroke / 6.0})
        settings.push_back({scales.position_low + (place + 0.5) / kPlaces * stroke, width});
    return {{{"F_b"}, {"y_b", "w_b"}, settings}};
  }

  T friction_curve(const Instant<T>& at) const {
    using std::exp;
    const T u = (at.position - y_b) / w_b;
    return F_b * exp(-(u * u));
  }
};

}  // namespace axisfit
