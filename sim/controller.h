// The sampled position controller around the axis.
//
// Every `period` it reads the encoder on the motor shaft and writes the command, held until the
// next sample. That of the paper, the slave control unit, samples every 5 ms, writes the
// set-velocity voltage and receives a track point (position and speed) from the master unit every
// 80 ms. The paper gives the periods and states that the law combines position, velocity and
// integrated position; the form and the gains are assumed. With e = reference - encoder, T_s the
// period, and v the difference of two readings over it,
//
//   w = k_ff reference' + k_p e + k_i T_s sum e          set velocity, within +-speed_limit
//   s = w - k_v v
//   u = gain (s + k_n T_s sum s) + k_a reference'' + u_0   command, within +-limit
//
// k_v = 0, k_n = 0, k_a = 0: the paper's. k_v = 1: the cascade of servo drives, position P and
// velocity PI with feedforwards. k_v = 0, k_ff = 0 and k_i = 0: the proportional law of hobby
// servos, of gain * k_p per metre. The integral of s is kept within
// what the limit allows.
//
// The law is a template: its command carries the derivatives of all that it read and of its gains.
// At a limit they are those of the limit. The encoder is read unrounded where there are
// derivatives: a reading in whole counts has none but zero, and what rounding adds is noise of 0.29
// counts.
#pragma once

#include <functional>
#include <span>

#include "sim/command.h"
#include "sim/controller_settings.h"
#include "sim/scalar.h"

namespace axisfit {

/// The reference at a sample of the controller.
struct ReferenceSample {
  double position = 0.0;      ///< m
  double speed = 0.0;         ///< m/s
  double acceleration = 0.0;  ///< m/s^2
};

/// What the controller remembers from one sample to the next.
template <class T>
struct ControllerMemory {
  bool has_read = false;
  T position{0.0};  ///< m, read at the sample before
  T sum{0.0};       ///< of e, m
  T held{0.0};      ///< k_n T_s sum s, in m/s
  T pending{0.0};   ///< command that is written and yet to act
};

/// The command at a sample, for the encoder position (m) read there and the one a period before.
template <class T>
T control(const Controller<T>& controller, const ReferenceSample& reference, const T& position,
          const T& position_before, ControllerMemory<T>& memory) {
  const ControllerGains<T>& g = controller.gains;
  const double period = controller.timing.period;
  const auto within = [](const T& x, const T& limit) {
    return value_of(x) > value_of(limit) ? limit : value_of(x) < -value_of(limit) ? T(-limit) : x;
  };
  const T error = reference.position - position;
  memory.sum += error;
  memory.has_read = true;
  memory.position = position;
  const T w =
      within(g.k_ff * reference.speed + g.k_p * error + g.k_i * period * memory.sum, g.speed_limit);
  const T s = w - g.k_v * ((position - position_before) / period);
  memory.held = within(memory.held + g.k_n * period * s, g.limit / g.gain);
  return within((s + memory.held) * g.gain + g.k_a * reference.acceleration + g.u_0, g.limit);
}

/// r_g y2 as the encoder reports it: in whole counts, rounded down, m.
double encoder_reading(double position, double pinion_radius, double counts_per_revolution);

/// The reference at the controller's sample number n.
using ReferenceSamples = std::function<ReferenceSample(long n)>;

/// From track points of a motion that begins at time zero: linear between them.
ReferenceSamples track_points(const ControllerTiming& timing, Reference reference);

/// From a recorded reference (m, at its times, s) for a controller whose first sample is at
/// `start`: the value there, and differences over the period. The schedule must outlive it.
ReferenceSamples recorded_reference(const ControllerTiming& timing, const Schedule& reference,
                                    double start);

/// The commands that the control law writes for a recorded motion, as a column: the command in
/// force from each of the instants `times` (s) on, from the reference and the recorded encoder
/// position (m). For recordings that lack the command itself.
std::vector<double> command_from_reference(const Controller<double>& controller,
                                           std::span<const double> times,
                                           const ReferenceSamples& reference,
                                           std::span<const double> position);

}  // namespace axisfit
