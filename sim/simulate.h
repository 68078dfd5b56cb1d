// The simulation of an axis over a command, with readings at given instants.
#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>

#include "sim/command.h"
#include "sim/integrator.h"
#include "sim/sampling.h"

namespace axisfit {

/// The target of a tracking simulation: measured values at the instants of the simulation, those of
/// a smooth curve from target_corners(). A series that the observer does not use may be empty.
struct TargetSeries {
  std::span<const double> velocity;  ///< m/s
  std::span<const double> position;  ///< m

  Target at(std::size_t i) const {
    return {velocity.empty() ? 0.0 : velocity[i], position.empty() ? 0.0 : position[i]};
  }
};

/// How a simulation ended.
struct SimulationResult {
  bool finished = false;    ///< false: not finite, chattering, or swinging too fast to be followed
  std::size_t reached = 0;  ///< number of instants that were read
  int events = 0;
  long steps = 0;
};

/// Options for a simulation that is compared with a recording, with budgets that such a simulation
/// stays far below: less than one event per sample, and a hundred steps for each sample and each
/// `step` (s). Parameters with which the axis chatters or oscillates faster are rejected.
inline IntegratorOptions recording_options(std::span<const double> times, double step) {
  const double samples = static_cast<double>(times.size());
  constexpr double kMost = 1e15;  // fits a long
  IntegratorOptions options;
  options.step = step;
  options.event_budget = 200 + static_cast<long>(0.5 * samples);
  options.step_budget =
      100'000 +
      static_cast<long>(std::min(kMost, 100.0 * (samples + (times.back() - times.front()) / step)));
  return options;
}

/// Simulates from times[0] on and calls read(i, integrator) at every instant times[i] (s,
/// increasing).
///
/// A reading precedes a command that switches at the same instant. With an observer, the target
/// runs linearly between the measured values. A dead time below zero, of a log that is late, is
/// allowed: the command is all known.
///
/// Disturbances, where there are any, are those at the instants. Between two of them their mean
/// acts.
template <class T, class Read>
SimulationResult simulate(const Model<T>& model, const Schedule& command,
                          std::span<const double> times, Read&& read, const Observer& observer = {},
                          const TargetSeries& measured = {}, const IntegratorOptions& options = {},
                          std::span<const Disturbance<T>> disturbances = {}) {
  SimulationResult simulation_result;
  IntegratorOptions even = options;
  even.has_disturbance = !disturbances.empty();
  if (times.size() > 1) even.interval = mean_interval(times);
  const bool linear = command.hold == Hold::linear;
  even.has_command_ramp = linear;
  Integrator<T> axis(model, observer, even);
  std::size_t next = 0;
  // What was measured had about its first value before.
  T in_force(linear && !command.values.empty() ? command.values.front() : 0.0);
  const T delay = axis.command_delay();
  // Commands that acted before the first instant.
  for (; next < command.times.size() && command.times[next] + value_of(delay) < times.front();
       ++next)
    in_force = T(command.values[next]);
  double slope = 0.0;
  if (linear && next > 0) {
    slope = command.slope_after(next - 1);
    in_force += slope * (times.front() - (command.times[next - 1] + delay));
  }
  axis.start(times.front(), in_force, measured.at(0));
  if (linear) axis.set_command_ramp(in_force, slope);
  const auto reaches = [&](const T& instant) {
    const bool reached = axis.advance_to(instant);
    simulation_result.events = axis.events();
    simulation_result.steps = axis.steps();
    return reached;
  };
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i > 0 && observer.active()) {
      const double duration = times[i] - times[i - 1];
      const Target from = measured.at(i - 1), to = measured.at(i);
      axis.set_target(from, {(to.velocity - from.velocity) / duration,
                             (to.position - from.position) / duration});
    }
    if (i > 0 && even.has_disturbance) {
      const Disturbance<T>&from = disturbances[i - 1], &to = disturbances[i];
      axis.set_disturbance({0.5 * (from.arm + to.arm), 0.5 * (from.motor + to.motor)});
    }
    for (; next < command.times.size(); ++next) {
      const T instant = command.times[next] + delay;
      if (!(value_of(instant) < times[i])) break;
      if (!reaches(instant)) return simulation_result;
      if (linear)
        axis.set_command_ramp(T(command.values[next]), command.slope_after(next));
      else
        axis.set_command(T(command.values[next]));
    }
    if (!reaches(T(times[i]))) return simulation_result;
    if (even.has_disturbance) axis.set_disturbance(disturbances[i]);
    read(i, axis);
    simulation_result.reached = i + 1;
  }
  simulation_result.finished = true;
  return simulation_result;
}

}  // namespace axisfit
