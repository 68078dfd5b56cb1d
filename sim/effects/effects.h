// The effects beyond the paper: the list that names them all.
//
// An effect is a struct template with its parameters as members, a `name` and a `meaning` for files
// and tables, a `visit` that describes its parameters, and one or more of the slots of slots.h.
// Zero strength is a regular point of every effect: there it vanishes, and its derivative exists.
// docs/effects.md holds the recipe for a new one. Whoever reads a slot folds over the list below.
#pragma once

#include <bitset>
#include <optional>
#include <string_view>
#include <tuple>

#include "sim/effects/added_mass.h"
#include "sim/effects/cogging_torque.h"
#include "sim/effects/command_offset.h"
#include "sim/effects/constant_force.h"
#include "sim/effects/coulomb_friction.h"
#include "sim/effects/curve_force.h"
#include "sim/effects/dahl_friction.h"
#include "sim/effects/directional_friction.h"
#include "sim/effects/drive_lag.h"
#include "sim/effects/elastic_mode.h"
#include "sim/effects/load_friction.h"
#include "sim/effects/periodic_force.h"
#include "sim/effects/position_friction.h"
#include "sim/effects/quadratic_drag.h"
#include "sim/effects/stribeck_friction.h"
#include "sim/effects/stroke_spring.h"
#include "sim/effects/torque_droop.h"
#include "sim/effects/torque_fade.h"
#include "sim/effects/torque_ripple.h"
#include "sim/scalar.h"

namespace axisfit {

template <class T>
using Effects =
    std::tuple<CoulombFriction<T>, ConstantForce<T>, QuadraticDrag<T>, DirectionalFriction<T>,
               StribeckFriction<T>, PositionFriction<T>, LoadFriction<T>, DahlFriction<T>,
               StrokeSpring<T>, PeriodicForce<T>, AddedMass<T>, ElasticMode<T>, CoggingTorque<T>,
               TorqueRipple<T>, TorqueDroop<T>, TorqueFade<T>, DriveLag<T>, CommandOffset<T>,
               ForceOverVelocity<T>, ForceOverPosition<T>, ForceOverMotorAngle<T>,
               ForceOverTime<T>>;

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

/// Place in the list of the effect of that name.
inline std::optional<std::size_t> effect_named(std::string_view name) {
  std::optional<std::size_t> found;
  const Effects<double> effects{};
  visit_effects(effects, [&](std::size_t index, const auto& effect) {
    if (effect.name == name) found = index;
  });
  return found;
}

namespace slots {

/// The present effects that have any strength, or are being differentiated by it. Leaving the
/// others out makes an axis with an effect of strength zero the axis without it, bit for bit.
template <class T>
EffectSet active_effects(const Effects<T>& effects, const EffectSet& present) {
  EffectSet active;
  visit_effects(effects, [&](std::size_t index, const auto& effect) {
    if (!present[index]) return;
    effect.visit(effect, [&](const Quantity& quantity, const T& member) {
      if (!quantity.shape && is_active(member)) active.set(index);
    });
  });
  return active;
}

/// The affine slots of all effects in the set.
template <class T>
Slots<T> affine(const Effects<T>& effects, const EffectSet& active) {
  Slots<T> total;
  visit_effects(effects, [&](std::size_t index, const auto& effect) {
    if constexpr (requires { effect.add_to(total); })
      if (active[index]) effect.add_to(total);
  });
  return total;
}

template <class T, class Read>
T sum(const Effects<T>& effects, const EffectSet& active, Read&& read) {
  T total(0.0);
  visit_effects(effects, [&](std::size_t index, const auto& effect) {
    if (active[index]) read(effect, total);
  });
  return total;
}

/// Smooth force on the arm, N.
template <class T>
T arm_force(const Effects<T>& effects, const EffectSet& active, const Instant<T>& at) {
  return sum(effects, active, [&](const auto& effect, T& total) {
    if constexpr (requires { effect.arm_force(at); }) total += effect.arm_force(at);
  });
}

/// Dry friction that is not affine, N.
template <class T>
T friction_curve(const Effects<T>& effects, const EffectSet& active, const Instant<T>& at) {
  return sum(effects, active, [&](const auto& effect, T& total) {
    if constexpr (requires { effect.friction_curve(at); }) total += effect.friction_curve(at);
  });
}

/// Smooth torque on the motor, N m.
template <class T>
T motor_torque(const Effects<T>& effects, const EffectSet& active, const Instant<T>& at) {
  return sum(effects, active, [&](const auto& effect, T& total) {
    if constexpr (requires { effect.motor_torque(at); }) total += effect.motor_torque(at);
  });
}

/// State of the hysteresis, 1.
template <class T>
T hysteresis(const Effects<T>& effects, const EffectSet& active, const Instant<T>& at) {
  return sum(effects, active, [&](const auto& effect, T& total) {
    if constexpr (requires { effect.hysteresis(at); }) total += effect.hysteresis(at);
  });
}

/// What the effects of a set need beyond numbers.
struct Needs {
  bool arm_force = false, friction_curve = false, motor_torque = false, hysteresis = false;
};

inline Needs needs(const EffectSet& active) {
  Needs found;
  const Effects<double> effects{};
  const Instant<double> at{};
  visit_effects(effects, [&](std::size_t index, const auto& effect) {
    if (!active[index]) return;
    found.arm_force |= requires { effect.arm_force(at); };
    found.friction_curve |= requires { effect.friction_curve(at); };
    found.motor_torque |= requires { effect.motor_torque(at); };
    found.hysteresis |= requires { effect.hysteresis(at); };
  });
  return found;
}

}  // namespace slots
}  // namespace axisfit
