#include "sim/controller.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace axisfit {

double encoder_reading(double position, double pinion_radius, double counts_per_revolution) {
  if (!(counts_per_revolution > 0.0)) return position;
  const double count = 2.0 * std::numbers::pi * pinion_radius / counts_per_revolution;
  return count * std::floor(position / count);
}

ReferenceSamples track_points(const ControllerTiming& timing, Reference reference) {
  return [timing, reference = std::move(reference)](long n) -> ReferenceSample {
    const double time = static_cast<double>(n) * timing.period;
    const double track = std::floor(time / timing.track_period * (1.0 + 1e-12));
    const double from = reference(track * timing.track_period);
    const double to = reference((track + 1.0) * timing.track_period);
    const double speed = (to - from) / timing.track_period;
    return {from + speed * (time - track * timing.track_period), speed, 0.0};
  };
}

ReferenceSamples recorded_reference(const ControllerTiming& timing, const Schedule& reference,
                                    double start) {
  const double period = timing.period;
  return [&reference, start, period](long n) -> ReferenceSample {
    const auto position = [&](long sample) {
      return reference.value_at(start + static_cast<double>(sample) * period + 1e-9 * period);
    };
    const double here = position(n), before = position(n - 1);
    return {here, (here - before) / period,
            (here - 2.0 * before + position(n - 2)) / (period * period)};
  };
}

std::vector<double> command_from_reference(const Controller<double>& controller,
                                           std::span<const double> times,
                                           const ReferenceSamples& reference,
                                           std::span<const double> position) {
  const double period = controller.timing.command_period();
  ControllerMemory<double> memory;
  if (!position.empty()) memory.begin(controller, position.front(), 0.0);
  std::vector<double> command;
  double in_force = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    // Sampling instants fall on samples of the recording, but for rounding.
    while (times.front() + static_cast<double>(memory.commands) * period <=
           times[i] + 1e-6 * period)
      in_force = control(controller, reference, position[i], memory);
    command.push_back(in_force);
  }
  return command;
}

}  // namespace axisfit
