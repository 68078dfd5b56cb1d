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

double SlaveControlUnit::sample(long n, double encoder_position) {
  const double time = static_cast<double>(n) * settings_.period;
  const double track = std::floor(time / settings_.track_period * (1.0 + 1e-12));
  const double from = reference_(track * settings_.track_period);
  const double to = reference_((track + 1.0) * settings_.track_period);
  const double speed = (to - from) / settings_.track_period;
  const double position = from + speed * (time - track * settings_.track_period);
  const double error = position - encoder_position;
  integral_ += error;
  const double u = (settings_.k_ff * speed + settings_.k_p * error +
                    settings_.k_i * settings_.period * integral_) *
                   settings_.gain;
  return std::clamp(u, -settings_.limit, settings_.limit);
}

Schedule simulate_controlled(
    const Model<double>& model, SlaveControlUnit& unit, std::span<const double> times,
    const std::function<void(std::size_t, const Integrator<double>&)>& read,
    const IntegratorOptions& options) {
  const ControllerSettings& settings = unit.settings();
  Schedule written;
  // A dead time below zero is that of a log, not of a machine.
  const double dead_time = std::max(0.0, model.axis.T_d);
  Integrator<double> axis(model, {}, options);
  const double start = times.front();
  axis.start(start, 0.0, {});
  long n = 0;
  // Reading and writing at the same instant: readings come first.
  for (std::size_t i = 0; i < times.size(); ++i) {
    while (true) {
      const double sampling = start + static_cast<double>(n) * settings.period;
      const double acting = written.times.size() == static_cast<std::size_t>(n)
                                ? sampling
                                : written.times.back() + dead_time;
      if (!(acting < times[i])) break;
      if (!axis.advance_to(acting)) return written;
      if (written.times.size() == static_cast<std::size_t>(n)) {  // time to sample
        const double position = model.axis.r_g * axis.state()[2];
        written.append(sampling, unit.sample(n, encoder_reading(position, model.axis.r_g,
                                                                settings.counts_per_revolution)));
      }
      if (written.times.back() + dead_time <= value_of(axis.time())) {  // time to act
        axis.set_command(written.values.back());
        ++n;
      }
    }
    if (!axis.advance_to(times[i])) return written;
    read(i, axis);
  }
  return written;
}

std::vector<double> command_from_reference(const ControllerSettings& settings,
                                           std::span<const double> times,
                                           std::span<const double> reference,
                                           std::span<const double> position) {
  SlaveControlUnit unit(settings, [&](double t) {
    const double instant = times.front() + t;
    const auto after = std::ranges::lower_bound(times, instant);
    if (after == times.end()) return reference.back();
    const auto i = static_cast<std::size_t>(after - times.begin());
    if (i == 0) return reference.front();
    const double share = (instant - times[i - 1]) / (times[i] - times[i - 1]);
    return reference[i - 1] + share * (reference[i] - reference[i - 1]);
  });
  std::vector<double> command;
  long n = 0;
  double in_force = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    // Sampling instants fall on samples of the recording, but for rounding.
    while (times.front() + static_cast<double>(n) * settings.period <=
           times[i] + 1e-6 * settings.period)
      in_force = unit.sample(n++, position[i]);
    command.push_back(in_force);
  }
  return command;
}

}  // namespace axisfit
