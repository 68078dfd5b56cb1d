// The sampled position controller around the axis.
//
// Every `period` it reads the encoder on the motor shaft and writes the command, held until the
// next sample. That of the paper, the slave control unit, samples every 5 ms, writes the
// set-velocity voltage and receives a track point (position and speed) from the master unit every
// 80 ms. The paper gives the periods and states that the law combines position, velocity and
// integrated position; the form and the gains are assumed. With e = reference - encoder, T_s the
// period, T_c = T_s / n that of a velocity loop of n samples in each, and v the difference of two
// readings over T_c,
//
//   w = k_ff reference' + k_p e + k_i T_s sum e    every T_s: set velocity, within +-speed_limit
//   s = w - k_v (v behind the lag T_v)             every T_c
//   u = gain (s + k_n T_c sum s) + k_a reference'' + u_0, within +-limit
//   command = u behind the lag T_u and the notch filter
//
// k_v = 0, k_n = 0, k_a = 0: the paper's. k_v = 1: the cascade of servo drives, position P and
// velocity PI with feedforwards. k_v = 0, k_ff = 0 and k_i = 0: the proportional law of hobby
// servos, of gain * k_p per metre. The integral of s is kept within what the limit allows.
//
// The lags are x += T_c / (T_c + T) (input - x). The notch filter of frequency f, width d and depth
// c is (s^2 + c d w s + w^2) / (s^2 + d w s + w^2), w = 2 pi f, by the bilinear transformation that
// keeps f (A. V. Oppenheim and R. W. Schafer, Discrete-Time Signal Processing, chapter 7). Both
// begin settled on the first command.
//
// The law is a template: its command carries the derivatives of all that it read and of its gains.
// At a limit they are those of the limit. The encoder is read unrounded where there are
// derivatives: a reading in whole counts has none but zero, and what rounding adds is noise of 0.29
// counts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <utility>

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

/// What the controller remembers from one command to the next.
template <class T>
struct ControllerMemory {
  long commands = 0;                       ///< that were written
  T position{0.0};                         ///< m, read at the command before
  T speed{0.0};                            ///< m/s, of the encoder, behind its lag
  T sum{0.0};                              ///< of e, m
  T set_velocity{0.0};                     ///< w, m/s
  T feedforward{0.0};                      ///< k_a reference''
  T held{0.0};                             ///< k_n T_c sum s, in m/s
  T lagged{0.0};                           ///< command behind its lag
  std::array<T, 2> notch{T(0.0), T(0.0)};  ///< its state, direct form II transposed
  /// Commands that were written, the last one first; those by a dead time of whole periods late
  /// are yet to act.
  std::array<T, kMostPeriodsLate> written{};
  T pending{0.0};  ///< command that acts next

  /// Before the first command: of an encoder that reads `at` (m) and has moved at `rate` (m/s).
  void begin(const Controller<T>& controller, const T& at, const T& rate) {
    position = at - controller.timing.command_period() * rate;
    speed = rate;
  }
};

/// A dead time as whole periods of the commands and the rest, which is shorter than one.
template <class T>
std::pair<std::size_t, T> whole_periods(const ControllerTiming& timing, const T& dead_time) {
  const double step = timing.command_period();
  const double whole = std::floor(std::max(0.0, value_of(dead_time)) / step * (1.0 + 1e-12));
  return {static_cast<std::size_t>(whole), T(dead_time - whole * step)};
}

/// Calls visit(x) for what decides on the commands to come, with these settings and so many whole
/// periods of dead time.
template <class T, class Visitor>
void visit_memory(const Controller<double>& controller, std::size_t periods_late,
                  ControllerMemory<T>& memory, Visitor&& visit) {
  for (std::size_t i = 0; i < periods_late; ++i) visit(memory.written[i]);
  visit(memory.pending);
  visit(memory.sum);
  visit(memory.held);
  visit(memory.position);
  if (controller.timing.velocity_samples > 1.0) {
    visit(memory.set_velocity);
    visit(memory.feedforward);
  }
  if (controller.gains.T_v > 0.0) visit(memory.speed);
  if (controller.gains.T_u > 0.0) visit(memory.lagged);
  if (controller.gains.notch_depth != 1.0)
    for (T& x : memory.notch) visit(x);
}

/// The command behind the notch filter.
template <class T>
T notched(const Controller<T>& controller, const T& command, ControllerMemory<T>& memory) {
  using std::tan;
  const ControllerGains<T>& g = controller.gains;
  if (!is_active(T(g.notch_depth - 1.0))) return command;
  const T k = tan(std::numbers::pi * controller.timing.command_period() * g.notch_frequency);
  const T square = k * k, width = g.notch_width * k, depth = g.notch_depth * width;
  const T whole = 1.0 / (1.0 + width + square);
  const T b0 = (1.0 + depth + square) * whole, b1 = 2.0 * (square - 1.0) * whole,
          b2 = (1.0 - depth + square) * whole, a2 = (1.0 - width + square) * whole;
  if (memory.commands == 0) memory.notch = {T((1.0 - b0) * command), T((b2 - a2) * command)};
  const T passed = b0 * command + memory.notch[0];
  memory.notch = {T(b1 * (command - passed) + memory.notch[1]), T(b2 * command - a2 * passed)};
  return passed;
}

/// The command for the encoder position (m) that is read now. `references` (controller's sample
/// number n) gives the ReferenceSample; the memory has begun.
template <class T, class References>
T control(const Controller<T>& controller, const References& references, const T& position,
          ControllerMemory<T>& memory) {
  const ControllerGains<T>& g = controller.gains;
  const double period = controller.timing.period, step = controller.timing.command_period();
  const auto within = [](const T& x, const T& limit) {
    return value_of(x) > value_of(limit) ? limit : value_of(x) < -value_of(limit) ? T(-limit) : x;
  };
  const auto lagging = [&](T& x, const T& input, const T& lag) {
    x = is_active(lag) ? T(x + step / (step + lag) * (input - x)) : input;
  };
  const long samples = std::lround(controller.timing.velocity_samples);
  if (memory.commands % samples == 0) {
    const ReferenceSample reference = references(memory.commands / samples);
    const T error = reference.position - position;
    memory.sum += error;
    memory.set_velocity = within(
        g.k_ff * reference.speed + g.k_p * error + g.k_i * period * memory.sum, g.speed_limit);
    memory.feedforward = g.k_a * reference.acceleration;
  }
  lagging(memory.speed, T((position - memory.position) / step), g.T_v);
  memory.position = position;
  const T s = memory.set_velocity - g.k_v * memory.speed;
  memory.held = within(memory.held + g.k_n * step * s, g.limit / g.gain);
  const T u = within((s + memory.held) * g.gain + memory.feedforward + g.u_0, g.limit);
  if (memory.commands == 0) memory.lagged = u;
  lagging(memory.lagged, u, g.T_u);
  const T command = notched(controller, memory.lagged, memory);
  ++memory.commands;
  return command;
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
