// The effects beyond the paper: the list that names them all, and the slots they fill.
//
// An effect is a struct template with its parameters as members, a `name` and a `meaning` for files
// and tables, a `visit` that describes its parameters, and one or more of these slots:
//
//   T friction_level() const;              N, arm side, dry friction with sticking, >= 0
//   T constant_force() const;              N, arm side, positive in the arm's positive direction
//   T arm_force(const State<T>&) const;    N, arm side, any smooth function of the state
//
// docs/effects.md holds the recipe for a new one. Whoever reads a slot folds over the list below;
// an effect that is not in the set of the axis costs one test of a bit.
#pragma once

#include <bitset>
#include <tuple>

#include "sim/effects/constant_force.h"
#include "sim/effects/coulomb_friction.h"
#include "sim/effects/quadratic_drag.h"

namespace axisfit {

template <class T>
using Effects = std::tuple<CoulombFriction<T>, ConstantForce<T>, QuadraticDrag<T>>;

inline constexpr std::size_t kEffects = std::tuple_size_v<Effects<double>>;

/// Which effects of the list an axis has, by their place in it.
using EffectSet = std::bitset<kEffects>;

/// Calls visit(index, effect) for every effect of the list, present or not.
template <class EffectsOfT, class Visitor>
void visit_effects(EffectsOfT& effects, Visitor&& visit) {
  std::apply(
      [&](auto&... effect) {
        std::size_t index = 0;
        (visit(index++, effect), ...);
      },
      effects);
}

namespace slots {

template <class T, class Read>
T sum(const Effects<T>& effects, const EffectSet& present, Read&& read) {
  T total(0.0);
  visit_effects(effects, [&](std::size_t index, const auto& effect) {
    if (present[index]) read(effect, total);
  });
  return total;
}

/// Dry friction of all present effects, N on the arm side.
template <class T>
T friction_level(const Effects<T>& effects, const EffectSet& present) {
  return sum(effects, present, [](const auto& effect, T& total) {
    if constexpr (requires { effect.friction_level(); }) total += effect.friction_level();
  });
}

/// Constant force of all present effects, N on the arm side.
template <class T>
T constant_force(const Effects<T>& effects, const EffectSet& present) {
  return sum(effects, present, [](const auto& effect, T& total) {
    if constexpr (requires { effect.constant_force(); }) total += effect.constant_force();
  });
}

/// State-dependent force of all present effects, N on the arm side.
template <class T>
T arm_force(const Effects<T>& effects, const EffectSet& present, const State<T>& y) {
  return sum(effects, present, [&](const auto& effect, T& total) {
    if constexpr (requires { effect.arm_force(y); }) total += effect.arm_force(y);
  });
}

/// Whether any present effect fills the slot friction_level.
inline bool have_friction(const EffectSet& present) {
  bool found = false;
  Effects<double> effects{};
  visit_effects(effects, [&](std::size_t index, const auto& effect) {
    if constexpr (requires { effect.friction_level(); }) found = found || present[index];
  });
  return found;
}

/// Whether any present effect fills the slot arm_force.
inline bool have_arm_force(const EffectSet& present) {
  bool found = false;
  Effects<double> effects{};
  visit_effects(effects, [&](std::size_t index, const auto& effect) {
    if constexpr (requires(const State<double>& y) { effect.arm_force(y); })
      found = found || present[index];
  });
  return found;
}

}  // namespace slots
}  // namespace axisfit
