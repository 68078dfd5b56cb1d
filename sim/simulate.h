// The simulation of an axis over a command, with readings at given instants.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "sim/command.h"
#include "sim/controller.h"
#include "sim/integrator.h"
#include "sim/sampling.h"

namespace axisfit {

/// Measured values at the instants of a simulation. Of its observer's target those of a smooth
/// curve from target_corners(); a series that the observer does not use may be empty.
struct MeasuredSeries {
  std::span<const double> velocity;              ///< m/s
  std::span<const double> position;              ///< m
  std::span<const ChannelSeries> channels = {};  ///< of the model; none: they are at their zero

  Target at(std::size_t i) const {
    return {velocity.empty() ? 0.0 : velocity[i], position.empty() ? 0.0 : position[i]};
  }
  /// From instants i to i + 1, at these times (s).
  ChannelCourse course(std::size_t i, std::span<const double> times) const {
    ChannelCourse course{times[i], {}, {}};
    for (std::size_t j = 0; j < channels.size(); ++j) {
      const auto& [values, hold] = channels[j];
      course.value[j] = values[i];
      if (hold == Hold::linear && i + 1 < times.size())
        course.slope[j] = (values[i + 1] - values[i]) / (times[i + 1] - times[i]);
    }
    return course;
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
/// stays far below: one event for two samples, six more for each switch of the command, after
/// which limits are reached and left and teeth part and meet, and twenty steps for each sample and
/// each `step` (s). Parameters with which the axis chatters or oscillates faster are rejected. More
/// switches than one for four samples count no more: they are small.
inline IntegratorOptions recording_options(std::span<const double> times, double switches,
                                           double step) {
  const double samples = static_cast<double>(times.size());
  constexpr double kMost = 1e15;  // fits a long
  IntegratorOptions options;
  options.step = step;
  options.event_budget =
      200 + static_cast<long>(0.5 * samples + 6.0 * std::min(switches, 0.25 * samples));
  options.step_budget =
      10'000 +
      static_cast<long>(std::min(kMost, 20.0 * (samples + (times.back() - times.front()) / step)));
  return options;
}

/// Commands that are known, one after the other.
template <class T>
class KnownCommands {
 public:
  explicit KnownCommands(const Schedule& command) : command_(command) {}

  void start(Integrator<T>& axis, double time, const Target& target) {
    const bool linear = command_.hold == Hold::linear;
    delay_ = axis.command_delay();
    // What was measured had about its first value before.
    T in_force(linear && !command_.values.empty() ? command_.values.front() : 0.0);
    // Commands that acted before the first instant.
    for (; next_ < command_.times.size() && command_.times[next_] + value_of(delay_) < time;
         ++next_)
      in_force = T(command_.values[next_]);
    double slope = 0.0;
    if (linear && next_ > 0) {
      slope = command_.slope_after(next_ - 1);
      in_force += slope * (time - (command_.times[next_ - 1] + delay_));
    }
    axis.start(time, in_force, target);
    if (linear) axis.set_command_ramp(in_force, slope);
  }
  /// When something happens next, s.
  std::optional<T> next() const {
    if (next_ == command_.times.size()) return std::nullopt;
    return command_.times[next_] + delay_;
  }
  /// Lets it happen, now.
  void act(Integrator<T>& axis) {
    if (command_.hold == Hold::linear)
      axis.set_command_ramp(T(command_.values[next_]), command_.slope_after(next_));
    else
      axis.set_command(T(command_.values[next_]));
    ++next_;
  }

 private:
  const Schedule& command_;
  std::size_t next_ = 0;
  T delay_{0.0};
};

/// Commands that the model's controller writes while it reads the encoder: every command_period(),
/// from the first instant on, and in force later by the dead time, of at most kMostPeriodsLate and
/// a part of a period. One below zero is that of a log, not of a machine. Before the first the
/// command is zero.
template <class T>
class ControlledCommands {
 public:
  /// `read` is what the controller sees of the axis, m; `written` is told of every command.
  using Read = std::function<T(const Integrator<T>&)>;
  using Written = std::function<void(double time, const T& command)>;
  ControlledCommands(const Controller<T>& controller, ReferenceSamples reference, Read read,
                     Written written = {})
      : controller_(controller),
        reference_(std::move(reference)),
        read_(std::move(read)),
        written_(std::move(written)) {}

  void start(Integrator<T>& axis, double time, const Target& target) {
    start_ = time;
    T delay = axis.command_delay();
    if (value_of(delay) < 0.0) delay = T(0.0);
    std::tie(periods_late_, delay_) = whole_periods(controller_.timing, delay);
    periods_late_ = std::min(periods_late_, kMostPeriodsLate);
    axis.start(time, T(0.0), target);
  }
  std::optional<T> next() const { return is_pending_ ? sample_time() + delay_ : T(sample_time()); }
  void act(Integrator<T>& axis) {
    ControllerMemory<T>& memory = axis.controller_memory();
    if (!is_pending_) {
      const T position = read_(axis);
      if (memory.commands == 0)
        memory.begin(controller_, position, T(axis.equations().radius() * axis.state()[3]));
      const T written = control(controller_, reference_, position, memory);
      if (written_) written_(sample_time(), written);
      // The command of so many periods before.
      memory.pending = periods_late_ == 0 ? written : memory.written[periods_late_ - 1];
      std::shift_right(memory.written.begin(), memory.written.end(), 1);
      memory.written.front() = written;
      is_pending_ = true;
      if (value_of(delay_) > 0.0 || ScalarTraits<T>::has_derivative(delay_)) return;
    }
    axis.set_command(memory.pending);
    is_pending_ = false;
    ++sample_;
  }

 private:
  double sample_time() const {
    return start_ + static_cast<double>(sample_) * controller_.timing.command_period();
  }

  const Controller<T>& controller_;
  ReferenceSamples reference_;
  Read read_;
  Written written_;
  double start_ = 0.0;
  long sample_ = 0;
  bool is_pending_ = false;
  std::size_t periods_late_ = 0;
  T delay_{0.0};  ///< s, behind whole periods
};

/// Simulates from times[0] on and calls read(i, integrator) at every instant times[i] (s,
/// increasing).
///
/// A reading precedes a command that switches at the same instant. With an observer, the target
/// runs linearly between the measured values; so do the channels. A dead time below zero, of a log
/// that is late, is allowed where the command is all known.
///
/// Disturbances, where there are any, are those at the instants. Between two of them their mean
/// acts.
template <class T, class Commands, class Read>
SimulationResult simulate_commands(const Model<T>& model, Commands&& commands,
                                   std::span<const double> times, Read&& read,
                                   const Observer& observer, const MeasuredSeries& measured,
                                   const IntegratorOptions& options,
                                   std::span<const Disturbance<T>> disturbances = {}) {
  SimulationResult simulation_result;
  IntegratorOptions even = options;
  even.has_disturbance = !disturbances.empty();
  if (times.size() > 1) even.interval = mean_interval(times);
  Integrator<T> axis(model, observer, even);
  if (!measured.channels.empty()) axis.set_channels(measured.course(0, times));
  commands.start(axis, times.front(), measured.at(0));
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
    if (i > 1 && !measured.channels.empty()) axis.set_channels(measured.course(i - 1, times));
    if (i > 0 && even.has_disturbance) {
      const Disturbance<T>&from = disturbances[i - 1], &to = disturbances[i];
      axis.set_disturbance({0.5 * (from.arm + to.arm), 0.5 * (from.motor + to.motor)});
    }
    while (const std::optional<T> instant = commands.next()) {
      if (!(value_of(*instant) < times[i])) break;
      if (!reaches(*instant)) return simulation_result;
      commands.act(axis);
    }
    if (!reaches(T(times[i]))) return simulation_result;
    if (even.has_disturbance) axis.set_disturbance(disturbances[i]);
    read(i, axis);
    simulation_result.reached = i + 1;
  }
  simulation_result.finished = true;
  return simulation_result;
}

/// The same with a schedule: of commands, or of the reference that the model's controller follows.
/// It then reads what the recorded position shows, without noise.
template <class T, class Read>
SimulationResult simulate(const Model<T>& model, const Schedule& schedule,
                          std::span<const double> times, Read&& read, const Observer& observer = {},
                          const MeasuredSeries& measured = {},
                          const IntegratorOptions& options = {},
                          std::span<const Disturbance<T>> disturbances = {}) {
  IntegratorOptions with_hold = options;
  if (schedule.meaning == Meaning::command) {
    with_hold.has_command_ramp = schedule.hold == Hold::linear;
    return simulate_commands(model, KnownCommands<T>(schedule), times, read, observer, measured,
                             with_hold, disturbances);
  }
  const auto encoder = [](const Integrator<T>& axis) {
    return reading(axis.equations(), Signal::position, axis.mode(), axis.state(), axis.input());
  };
  return simulate_commands(
      model,
      ControlledCommands<T>(model.controller,
                            recorded_reference(model.controller.timing, schedule, times.front()),
                            encoder),
      times, read, observer, measured, with_hold, disturbances);
}

/// Simulates the axis under its controller through a motion with this reference (m), from times[0]
/// on, with the encoder read in counts, and calls read(i, axis) at every instant; returns the
/// commands that were written. The schedule ends early if the simulation fails.
template <class Read>
Schedule simulate_move(const Model<double>& model, Reference reference,
                       std::span<const double> times, Read&& read,
                       const IntegratorOptions& options = {},
                       std::span<const ChannelSeries> channels = {}) {
  Schedule written;
  const ControllerTiming& timing = model.controller.timing;
  const auto encoder = [&](const Integrator<double>& axis) {
    const double radius = axis.equations().radius();
    return encoder_reading(radius * axis.state()[2], radius, timing.counts_per_revolution);
  };
  simulate_commands(model,
                    ControlledCommands<double>(
                        model.controller, track_points(timing, std::move(reference)), encoder,
                        [&](double time, double command) { written.append(time, command); }),
                    times, read, {}, {{}, {}, channels}, options);
  return written;
}

}  // namespace axisfit
