#pragma once

#include <cmath>
#include <numbers>

#include "sim/effects/slots.h"

namespace axisfit {

/// A force on the arm that is periodic along the stroke: rack pitch, rollers of a guide, magnets of
/// a linear motor. The third harmonic makes its tops flat or pointed.
///
///   F = F_s1 sin(q) + F_c1 cos(q) + F_s2 sin(2 q) + F_c2 cos(2 q) + F_s3 sin(3 q) + F_c3 cos(3 q),
///   q = 2 pi y0 / period
///
/// A motor whose magnets and slots cog with two periods, of which neither is a low harmonic of the
/// other, has two such elements, the second an effect of its own.
template <class T, int kElement>
struct PeriodicElement {
  static constexpr bool kIsFirst = kElement == 1;
  static constexpr std::string_view name = kIsFirst ? "periodic_force" : "second_periodic_force";
  static constexpr std::string_view meaning =
      kIsFirst ? "force that is periodic along the stroke"
               : "a second force that is periodic along the stroke, with another period";
  static constexpr ActsOn acts_on = ActsOn::arm_force;
  static constexpr std::string_view excitation = "slow motion over many periods";

  T F_s1, F_c1, F_s2, F_c2, F_s3, F_c3, period;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_s1", "N", "sine coefficient, first harmonic", -1e5, 1e5}.typically(12.0),
          self.F_s1);
    visit(Quantity{"F_c1", "N", "cosine coefficient, first harmonic", -1e5, 1e5}.typically(-7.0),
          self.F_c1);
    visit(Quantity{"F_s2", "N", "sine coefficient, second harmonic", -1e5, 1e5, 0.0}.typically(4.0),
          self.F_s2);
    visit(
        Quantity{"F_c2", "N", "cosine coefficient, second harmonic", -1e5, 1e5, 0.0}.typically(3.0),
        self.F_c2);
    visit(Quantity{"F_s3", "N", "sine coefficient, third harmonic", -1e5, 1e5, 0.0}.typically(2.0),
          self.F_s3);
    visit(
        Quantity{"F_c3", "N", "cosine coefficient, third harmonic", -1e5, 1e5, 0.0}.typically(-1.5),
        self.F_c3);
    visit(Quantity{"period", "m", "spatial period", 1e-5, 1e3, kRequired, UsedBy::every_axis, true}
              .typically(kIsFirst ? 0.036 : 0.007),
          self.period);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    SearchEntry element{.strengths = {"F_s1", "F_c1"},
                        .shapes = {"period"},
                        .settings = one_by_one(scales.periods),
                        .largest = {scales.position_high - scales.position_low},
                        .has_phase = true};
    if (!kIsFirst) element.extends = PeriodicElement<T, 1>::name;
    return {element,
            {.strengths = {"F_s2", "F_c2"}, .extends = name, .has_phase = true},
            {.strengths = {"F_s3", "F_c3"}, .extends = name, .has_phase = true}};
  }

  T arm_force(const Instant<T>& at) const {
    using std::cos, std::sin;
    const T q = 2.0 * std::numbers::pi * at.position / period;
    const T s1 = sin(q), c1 = cos(q);
    const T s2 = 2.0 * s1 * c1, c2 = c1 * c1 - s1 * s1;
    return F_s1 * s1 + F_c1 * c1 + F_s2 * s2 + F_c2 * c2 + F_s3 * (s2 * c1 + c2 * s1) +
           F_c3 * (c2 * c1 - s2 * s1);
  }
};

template <class T>
using PeriodicForce = PeriodicElement<T, 1>;
template <class T>
using SecondPeriodicForce = PeriodicElement<T, 2>;

}  // namespace axisfit
