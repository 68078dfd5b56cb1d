#pragma once

#include <algorithm>
#include <cmath>

#include "sim/effects/slots.h"
#include "sim/scalar.h"

namespace axisfit {

/// A payload that is picked up, or set down, at an instant of the recording. From t_c on, within a
/// few hundredths of a second, the mass is M + dM, and on an axis that is not level a force dF is
/// added, its weight:
///
///   (M + s dM) y1' = ... + s dF,   s = 1 / (1 + exp(-(t - t_c) / 10 ms))
///
/// It is picked up and set down at rest: the change itself takes no momentum, as that of
/// ChannelMass does.
template <class T>
struct PayloadChange {
  static constexpr std::string_view name = "payload_change";
  static constexpr std::string_view meaning = "mass that changes at an instant";
  static constexpr ActsOn acts_on = ActsOn::inertia;
  static constexpr std::string_view excitation = "like acceleration before and after the change";

  T dM, dF, t_c;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"dM", "kg", "mass added from then on", -1e5, 1e5, 0.0}.typically(8.0), self.dM);
    visit(Quantity{"dF", "N", "its weight along the stroke", -1e5, 1e5, 0.0}.typically(12.0),
          self.dF);
    visit(Quantity{"t_c", "s", "instant of the change", -1e6, 1e6, kRequired, UsedBy::every_axis,
                   true}
              .typically(0.36),
          self.t_c);
  }

  /// Without and with its weight, at instants spread over the recordings.
  static std::vector<SearchEntry> search(const SearchScales& scales) {
    constexpr int kInstants = 9;
    ShapeSettings settings;
    for (int i = 1; i <= kInstants; ++i)
      settings.push_back({scales.start + (scales.end - scales.start) * i / (kInstants + 1.0)});
    return {{{"dM"}, {"t_c"}, settings}, {{"dM", "dF"}, {"t_c"}, settings}};
  }

  T mass(const Instant<T>& at) const { return dM * part(at.time); }
  T mass_rate(const Instant<T>&) const { return T(0.0); }
  T arm_force(const Instant<T>& at) const { return dF * part(at.time); }

 private:
  /// Of the change that has happened.
  T part(const T& time) const {
    using std::exp;
    constexpr double kRate = 100.0, kNever = 40.0;  // 1/s; beyond rounding
    const T x = kRate * (time - t_c);
    if (std::abs(value_of(x)) > kNever) return T(value_of(x) > 0.0 ? 1.0 : 0.0);
    return 1.0 / (1.0 + exp(-x));
  }
};

}  // namespace axisfit
