// A servo drive of which only the reference and the encoder were recorded. It is simulated here and
// not by the project: Euler steps of 20 us with the controller and a rounding encoder.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "fit/estimate/estimate.h"
#include "tests/sim/axes.h"

namespace axisfit {

struct Servo {
  double mass = 23.0, viscous = 45.0, coulomb = 18.0;      // kg, N s/m, N
  double force = 80.0;                                     // N/A
  double k_p = 30.0, gain = 15.0, k_n = 20.0, k_ff = 0.9;  // see sim/controller.h
  double limit = 12.0;                                     // A
  double period = 2e-3, count = 2e-6;                      // s, m
};

/// Moves to and fro with ramps of two speeds, recorded at every sample of the controller.
inline Recording servo_recording(const Servo& s, Role role) {
  constexpr int kSteps = 100;
  constexpr std::size_t kSamples = 1500;
  Recording recording;
  recording.name = role == Role::fit ? "fit" : "check";
  recording.role = role;
  std::vector<double> times, reference, position;
  double x = 0.0, v = 0.0, held = 0.0, before = 0.0, u = 0.0;
  const double fast = role == Role::fit ? 0.5 : 0.35;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double t = s.period * static_cast<double>(k);
    const double last = reference.empty() ? 0.0 : reference.back();
    const double speed = t < 0.1   ? 0.0
                         : t < 0.6 ? fast
                         : t < 0.9 ? 0.0
                         : t < 1.7 ? -0.7 * fast
                         : t < 2.0 ? 0.0
                                   : 0.2 * fast;
    times.push_back(t);
    reference.push_back(last + speed * s.period);
    position.push_back(s.count * std::floor(x / s.count));
    const double error = reference.back() - position.back();
    const double excess = s.k_ff * (reference.back() - last) / s.period + s.k_p * error -
                          (position.back() - before) / s.period;
    before = position.back();
    held = std::clamp(held + s.k_n * s.period * excess, -s.limit / s.gain, s.limit / s.gain);
    u = std::clamp(s.gain * (excess + held), -s.limit, s.limit);
    const double h = s.period / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const double free = v + h * (s.force * u - s.viscous * v) / s.mass;
      v = std::copysign(std::fdim(std::abs(free), h * s.coulomb / s.mass), free);
      x += h * v;
    }
  }
  recording.times = times;
  recording.command = schedule_from_samples(times, reference);
  recording.command.meaning = Meaning::reference;
  Measurement& measurement = recording.measurements.emplace_back();
  measurement.signal = Signal::position;
  measurement.values = position;
  measurement.sigma = s.count / std::sqrt(12.0);
  measurement.noise = NoiseSource::given;
  return recording;
}

inline Job servo_job(const Servo& s) {
  Job job;
  job.model.structure = {Drive::motor_current, Transmission::rigid};
  job.model.structure.closed_loop = true;
  add_effect<CoulombFriction>(job.model).F_c = 5.0;
  job.model.axis = paper_axis().axis;
  job.model.axis.K_f = s.force;
  job.model.axis.F_s = 0.0;
  normalize(job.model);
  job.model.controller.timing.period = s.period;
  job.model.controller.gains = {.k_ff = s.k_ff,
                                .k_p = s.k_p,
                                .k_i = 0.0,
                                .gain = s.gain,
                                .k_v = 1.0,
                                .k_n = s.k_n,
                                .limit = s.limit};
  job.recordings = {servo_recording(s, Role::fit), servo_recording(s, Role::validate)};
  job.free = {free_parameter("M", 8.0), free_parameter("B_a", 150.0),
              free_parameter("coulomb_friction.F_c", 5.0)};
  return job;
}

}  // namespace axisfit
