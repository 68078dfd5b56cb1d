// A slide whose model lacks a force that wanders.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "tests/fit/example.h"

namespace axisfit {

constexpr double kMass = 20.0, kDamping = 30.0, kFriction = 8.0;  // of the slide

/// A slide of a program of its own, in steps of 0.1 ms: besides its friction a force pushes it that
/// wanders slowly, with this amplitude (N), and that its model lacks. Its position is recorded.
inline Job wandering_slide(double amplitude) {
  Job job;
  job.model = driven_mass(kMass);
  job.model.axis.K_f = 40.0;
  job.model.axis.B_a = kDamping;
  add_effect<CoulombFriction>(job.model).F_c = kFriction;
  constexpr double kStep = 1e-4, kInterval = 5e-3, kDuration = 16.0;
  constexpr int kEvery = 50;
  Normal noise(7);
  std::vector<double> times, commands, positions;
  double position = 0.0, velocity = 0.0;
  const auto command_at = [](double t) {
    constexpr std::array kLevels{1.0, -1.2, 0.6, -0.3, 1.4, -0.9, -0.5, 0.8};
    return kLevels[static_cast<std::size_t>(t / 0.4) % kLevels.size()];
  };
  for (int i = 0; i <= static_cast<int>(kDuration / kStep); ++i) {
    const double t = i * kStep;
    if (i % kEvery == 0) {
      times.push_back(kInterval * static_cast<double>(times.size()));
      commands.push_back(command_at(t + 1e-9));
      positions.push_back(position + usual_noise(Signal::position) * noise());
    }
    const double pushed = 40.0 * command_at(t + 1e-9) - kDamping * velocity +
                          amplitude * std::sin(2.0 * std::numbers::pi * t / 11.0);
    const double next = velocity + kStep / kMass * pushed;
    const double most = kStep / kMass * kFriction;
    velocity = std::abs(next) <= most ? 0.0 : next - std::copysign(most, next);
    position += kStep * velocity;
  }
  Recording& recording = job.recordings.emplace_back();
  recording.name = "fit";
  recording.times = times;
  recording.command = schedule_from_samples(recording.times, commands);
  recording.initial_state = InitialState::data;
  Measurement& m = recording.measurements.emplace_back();
  m.signal = Signal::position;
  m.values = positions;
  m.sigma = usual_noise(Signal::position);
  m.noise = NoiseSource::given;
  job.free = {free_parameter("M", 25.0), free_parameter("B_a", 20.0),
              free_parameter("coulomb_friction.F_c", 5.0)};
  job.options.threads = 1;
  return job;
}

}  // namespace axisfit
