// Where an effect can act on the axis, and which variables it can use.
//
// Slots that keep the equations affine within a mode are plain numbers: an effect adds to them in
//
//   void add_to(Slots<T>& slots) const;
//
// and they cost very little. Any other force is a smooth function of one instant,
//
//   T arm_force(const Instant<T>&) const;       N on the arm, positive in its positive direction
//   T friction_curve(const Instant<T>&) const;  N against the arm's motion, with sticking
//   T motor_torque(const Instant<T>&) const;    N m on the motor
//
// and goes through the Runge-Kutta part of the integrator, as does a mass that changes,
//
//   T mass(const Instant<T>&) const;            kg, added to the arm
//   T mass_rate(const Instant<T>&) const;       kg/s
//
// Such a force may depend on a hysteresis,
// the state of which is known in closed form since the arm last came to rest,
//
//   T hysteresis(const Instant<T>&) const;      and at.memory holds what it was there
//
// A force that jumps needs a guard (equations.h), as dry friction has.
#pragma once

#include "sim/channel.h"
#include "sim/effects/search.h"
#include "sim/quantity.h"

namespace axisfit {

template <class T>
struct Slots {
  T constant_force{0.0};      ///< N, on the arm
  T stiffness{0.0};           ///< N/m, of a spring that pulls the arm to position zero
  T friction_level{0.0};      ///< N, dry friction with sticking
  T friction_asymmetry{0.0};  ///< N, added to it in the positive direction, taken off in the other
  T friction_slope{0.0};      ///< N/m, added to it per metre of the arm's position
  T load_friction{0.0};       ///< 1, added to it per newton of transmitted force
  T load_curve{0.0};          ///< 1, the same by a friction curve: the force's sign needs a guard
  T viscous_asymmetry{0.0};   ///< N s/m, added to B_a in the positive direction, taken off else
  T added_mass{0.0};          ///< kg, on the arm
  T command_offset{0.0};      ///< V, added to U
  T drive_lag{0.0};           ///< s, time constant with which the power stage follows its input
  T supply_resistance{0.0};   ///< ohm, in series with the motor at the limit V_s
  T compliance{0.0};          ///< m/N, by which the motor's encoder is ahead of a rigid arm
  T play{0.0};                ///< m, the same in the sense of the force
  T elastic_mass{0.0};        ///< kg, the part of the arm that a spring carries, and of that mode
  T elastic_frequency{0.0};   ///< rad/s, with the arm held, and
  T elastic_damping{0.0};     ///< 1, damping ratio

  bool operator==(const Slots&) const = default;
};

/// Where the arm last came to rest, and the state there of the hysteresis of the effect that asks;
/// see DahlFriction.
template <class T>
struct Memory {
  T position{0.0};    ///< m
  T hysteresis{0.0};  ///< from -1 to 1, or what the effect says
};

/// What an effect sees of the axis. Forces and speeds on the arm side.
template <class T>
struct Instant {
  T time;          ///< s, of the recording
  T position;      ///< m, y0
  T velocity;      ///< m/s, y1
  int direction;   ///< sign of the velocity; 0 while the arm sticks
  T motor_angle;   ///< rad, y2
  T current;       ///< A; zero for a force source
  T drive_force;   ///< N, of the motor by its current
  T drive_torque;  ///< N m, the same at the motor
  T load;          ///< N, that the transmission carries; >= 0 where its sign has a guard
  Memory<T> memory = {};
  const ChannelCourse* channels = nullptr;  ///< null: all zero
};

}  // namespace axisfit
