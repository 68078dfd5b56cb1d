#pragma once

#include <cmath>

#include "sim/effects/slots.h"
#include "sim/scalar.h"

namespace axisfit {

/// Presliding hysteresis: after each reversal the friction builds up over a short travel, as the
/// asperities of the surfaces bend before they slip,
///
///   F = F_d z + B_d l_d z',  dz/dy0 = (1 - direction z) / l_d,
///
/// stiffness F_d / l_d at the reversal. The damping B_d acts only while the asperities bend.
/// Between two reversals z has a closed form in the travel since the first of them, so that no fast
/// state has to be integrated. It starts at z = 0. An observer may move the axis back against its
/// velocity: z waits until the travel is made up for.
///
/// Surfaces that bend over two lengths have two such elements, the second an effect of its own.
///
/// Source: P. R. Dahl (1968); B_d is sigma_1 of LuGre (Canudas de Wit et al., IEEE TAC 40, 1995),
/// whose Stribeck curve is an effect of its own. Several elements: as in the generalised Maxwell
/// slip of F. Al-Bender, V. Lampaert and J. Swevers, IEEE TAC 50 (2005), where each slips abruptly.
template <class T, int kElement>
struct DahlElement {
  static constexpr bool kIsFirst = kElement == 1;
  static constexpr std::string_view name = kIsFirst ? "dahl_friction" : "second_dahl_friction";
  static constexpr std::string_view meaning =
      kIsFirst ? "friction that builds up over a short travel"
               : "a second friction that builds up over another travel";
  static constexpr ActsOn acts_on = ActsOn::friction;
  static constexpr std::string_view excitation =
      "many reversals, sampled more densely than friction builds up";

  T F_d, l_d, B_d{0.0};

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"F_d", "N", "steady friction after a long travel", 0, 1e5}.typically(10.0),
          self.F_d);
    visit(Quantity{"l_d", "m", "travel over which it builds up", 1e-7, 1, kRequired,
                   UsedBy::every_axis, true}
              .typically(kIsFirst ? 2e-4 : 1e-3),
          self.l_d);
    visit(Quantity{"B_d", "N s/m", "viscous friction while it builds up", 0, 1e6, 0.0}.typically(
              20.0),
          self.B_d);
  }

  static std::vector<SearchEntry> search(const SearchScales& scales) {
    SearchEntry element{
        {"F_d"}, {"l_d"}, geometric(0.01 * scales.short_travel, 10.0 * scales.short_travel, 4)};
    if (!kIsFirst) element.extends = DahlElement<T, 1>::name;
    return {element, {.strengths = {"B_d"}, .extends = name}};
  }

  T hysteresis(const Instant<T>& at) const {
    using std::exp;
    const double s = at.direction;
    const T travel = s * (at.position - at.memory.position);
    if (s == 0.0 || travel < 0.0) return at.memory.hysteresis;
    return s - (s - at.memory.hysteresis) * exp(-travel / l_d);
  }

  T arm_force(const Instant<T>& at) const {
    const T z = hysteresis(at);
    T force = -(F_d * z);
    if (is_active(B_d)) force -= B_d * at.velocity * (1.0 - double(at.direction) * z);
    return force;
  }
};

template <class T>
using DahlFriction = DahlElement<T, 1>;
template <class T>
using SecondDahlFriction = DahlElement<T, 2>;

}  // namespace axisfit
