// The effects beyond the paper: the list that names them all.
//
// An effect is a struct template with its parameters as members, a `name` and a `meaning` for files
// and tables, a `visit` that describes its parameters, what search.h asks of it, and one or more of
// the slots of slots.h. Zero strength is a regular point of every effect: there it vanishes, and
// its derivative exists. docs/effects.md holds the recipe for a new one. Whoever wants to know
// something of effects folds over the list below: there is no other.
#pragma once

#include <array>
#include <bitset>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "sim/effects/added_mass.h"
#include "sim/effects/channel_effect.h"
#include "sim/effects/cogging_torque.h"
#include "sim/effects/command_offset.h"
#include "sim/effects/constant_force.h"
#include "sim/effects/coulomb_friction.h"
#include "sim/effects/curve.h"
#include "sim/effects/dahl_friction.h"
#include "sim/effects/directional_friction.h"
#include "sim/effects/drive_lag.h"
#include "sim/effects/elastic_mode.h"
#include "sim/effects/end_stops.h"
#include "sim/effects/force_droop.h"
#include "sim/effects/friction_bump.h"
#include "sim/effects/load_friction.h"
#include "sim/effects/payload_change.h"
#include "sim/effects/pendulum_gravity.h"
#include "sim/effects/periodic_force.h"
#include "sim/effects/position_friction.h"
#include "sim/effects/quadratic_drag.h"
#include "sim/effects/quadratic_load_friction.h"
#include "sim/effects/running_in_friction.h"
#include "sim/effects/soft_transmission.h"
#include "sim/effects/stribeck_friction.h"
#include "sim/effects/stribeck_load_friction.h"
#include "sim/effects/stroke_spring.h"
#include "sim/effects/supply_resistance.h"
#include "sim/effects/torque_droop.h"
#include "sim/effects/torque_fade.h"
#include "sim/effects/torque_ripple.h"
#include "sim/effects/warming_friction.h"
#include "sim/effects/warming_grease.h"
#include "sim/scalar.h"

namespace axisfit {

template <class T>
using Effects =
    std::tuple<CoulombFriction<T>, ConstantForce<T>, QuadraticDrag<T>, DirectionalFriction<T>,
               StribeckFriction<T>, PositionFriction<T>, FrictionBump<T>, LoadFriction<T>,
               QuadraticLoadFriction<T>, StribeckLoadFriction<T>, DahlFriction<T>,
               SecondDahlFriction<T>, WarmingFriction<T>, WarmingGrease<T>, RunningInFriction<T>,
               StrokeSpring<T>, EndStops<T>, PendulumGravity<T>, PeriodicForce<T>,
               SecondPeriodicForce<T>, AddedMass<T>, PayloadChange<T>, ElasticMode<T>,
               SoftTransmission<T>, CoggingTorque<T>, TorqueRipple<T>, TorqueDroop<T>,
               ForceDroop<T>, TorqueFade<T>, DriveLag<T>, CommandOffset<T>, SupplyResistance<T>,
               ChannelForce<T>, ChannelFriction<T>, ChannelDamping<T>, ChannelGain<T>,
               ChannelMass<T>, ForceOverVelocity<T>, ForceOverPosition<T>, ForceOverMotorAngle<T>,
               ForceOverTime<T>, FrictionOverVelocity<T>, FrictionOverPosition<T>>;

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

/// What an effect is, whatever its parameters.
struct EffectInfo {
  std::string_view name, meaning;
  ActsOn acts_on;
  std::string_view excitation;  ///< what a motion must do to show it, in words after "needs"
  std::vector<SearchEntry> (*search)(const SearchScales&);
};

/// Of all effects, in the order of the list.
inline constexpr std::array<EffectInfo, kEffects> kEffectTable =
    []<class... Effect>(std::type_identity<std::tuple<Effect...>>) {
      return std::array{EffectInfo{Effect::name, Effect::meaning, Effect::acts_on,
                                   Effect::excitation, &Effect::search}...};
    }(std::type_identity<Effects<double>>());

/// Place in the list of the effect of that name.
inline std::optional<std::size_t> effect_named(std::string_view name) {
  for (std::size_t index = 0; index < kEffects; ++index)
    if (kEffectTable[index].name == name) return index;
  return std::nullopt;
}

/// Whether an effect has a hysteresis, which is remembered for it at every stop.
template <class Effect>
inline constexpr bool kHasHysteresis = requires {
  &Effect::hysteresis;
};

/// Before each effect of the list, and after the last: the number of effects with a hysteresis.
inline constexpr std::array<std::size_t, kEffects + 1> kHysteresesBefore =
    []<class... Effect>(std::type_identity<std::tuple<Effect...>>) {
      std::array<std::size_t, kEffects + 1> before{};
      std::size_t index = 0;
      ((before[index + 1] = before[index] + kHasHysteresis<Effect>, ++index), ...);
      return before;
    }(std::type_identity<Effects<double>>());

/// One value for each effect with a hysteresis.
template <class T>
using Hystereses = std::array<T, kHysteresesBefore[kEffects]>;

/// Where the arm last came to rest, and all hystereses there.
template <class T>
struct RestMemory {
  T position{0.0};  ///< m
  Hystereses<T> hystereses{};
};

/// The same without derivatives.
template <class T>
RestMemory<double> value_of(const RestMemory<T>& memory) {
  RestMemory<double> plain{value_of(memory.position), {}};
  for (std::size_t i = 0; i < plain.hystereses.size(); ++i)
    plain.hystereses[i] = value_of(memory.hystereses[i]);
  return plain;
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

/// Calls read(index, effect) for the effects in the set, each with its own memory at the instant.
template <class T, class Read>
void visit_active(const Effects<T>& effects, const EffectSet& active, Instant<T>& at,
                  const RestMemory<T>& memory, Read&& read) {
  visit_effects(effects, [&]<class Effect>(std::size_t index, const Effect& effect) {
    if (!active[index]) return;
    if constexpr (kHasHysteresis<Effect>)
      at.memory = {memory.position, memory.hystereses[kHysteresesBefore[index]]};
    read(index, effect);
  });
}

/// Smooth force on the arm, N.
template <class T>
T arm_force(const Effects<T>& effects, const EffectSet& active, Instant<T> at,
            const RestMemory<T>& memory) {
  T total(0.0);
  visit_active(effects, active, at, memory, [&](std::size_t, const auto& effect) {
    if constexpr (requires { effect.arm_force(at); }) total += effect.arm_force(at);
  });
  return total;
}

/// Dry friction that is not affine, N.
template <class T>
T friction_curve(const Effects<T>& effects, const EffectSet& active, Instant<T> at,
                 const RestMemory<T>& memory) {
  T total(0.0);
  visit_active(effects, active, at, memory, [&](std::size_t, const auto& effect) {
    if constexpr (requires { effect.friction_curve(at); }) total += effect.friction_curve(at);
  });
  return total;
}

/// Smooth torque on the motor, N m.
template <class T>
T motor_torque(const Effects<T>& effects, const EffectSet& active, Instant<T> at,
               const RestMemory<T>& memory) {
  T total(0.0);
  visit_active(effects, active, at, memory, [&](std::size_t, const auto& effect) {
    if constexpr (requires { effect.motor_torque(at); }) total += effect.motor_torque(at);
  });
  return total;
}

/// Mass of the arm that changes, kg, and its rate, kg/s.
template <class T>
std::pair<T, T> mass(const Effects<T>& effects, const EffectSet& active, Instant<T> at,
                     const RestMemory<T>& memory) {
  std::pair<T, T> total{T(0.0), T(0.0)};
  visit_active(effects, active, at, memory, [&](std::size_t, const auto& effect) {
    if constexpr (requires { effect.mass(at); }) {
      total.first += effect.mass(at);
      total.second += effect.mass_rate(at);
    }
  });
  return total;
}

/// What is to be remembered of an arm that comes to rest.
template <class T>
RestMemory<T> memory_of(const Effects<T>& effects, const EffectSet& active, Instant<T> at,
                        const RestMemory<T>& memory) {
  RestMemory<T> next{at.position, {}};
  visit_active(effects, active, at, memory,
               [&]<class Effect>(std::size_t index, const Effect& effect) {
                 if constexpr (kHasHysteresis<Effect>)
                   next.hystereses[kHysteresesBefore[index]] = effect.hysteresis(at);
               });
  return next;
}

/// What the effects of a set need beyond numbers.
struct Needs {
  bool arm_force = false, friction_curve = false, motor_torque = false, mass = false,
       hysteresis = false;

  /// Whether any of it goes through the Runge-Kutta part of the integrator.
  bool is_smooth() const { return arm_force || friction_curve || motor_torque || mass; }
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
    found.mass |= requires { effect.mass(at); };
    found.hysteresis |= kHysteresesBefore[index] < kHysteresesBefore[index + 1];
  });
  return found;
}

}  // namespace slots
}  // namespace axisfit
