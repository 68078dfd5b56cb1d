// Small jobs with a known truth, for the tests of the fit.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "fit/estimate/estimate.h"
#include "fit/solve/residual.h"
#include "fit/solve/solve.h"
#include "sim/rig.h"
#include "tests/base/noise.h"
#include "tests/fit/parameter_ids.h"
#include "tests/sim/axes.h"

namespace axisfit {

/// Standard deviation of the noise of an instrument in these tests, in the signal's unit.
constexpr double usual_noise(Signal signal) {
  switch (signal) {
    case Signal::position:
      return 1e-4;
    case Signal::velocity:
      return 2e-3;
    case Signal::tachometer:
      return 2e-2;
    default:
      return 5e-2;
  }
}

/// What instruments with the usual noise record of an axis. `noisy` false: exact readings, whose
/// errors are still stated as the usual ones.
inline Recording recorded(const Model<double>& truth, const Motion& motion, double duration,
                          std::uint64_t seed,
                          const std::vector<Signal>& signals = {Signal::velocity,
                                                                Signal::acceleration},
                          bool noisy = true) {
  Rig rig;
  rig.model = truth;
  rig.model.controller.timing.counts_per_revolution = 0.0;
  for (const Signal signal : signals) rig.noise[index_of(signal)] = usual_noise(signal);
  RecordingOptions options;
  options.duration = duration;
  options.seed = seed;
  options.signals = signals;
  options.noise = noisy;
  const std::vector<Column> columns = record(rig, motion, options);
  Recording recording;
  recording.name = "fit";
  recording.times = columns[0].values;
  recording.command = schedule_from_samples(recording.times, columns[1].values);
  for (std::size_t s = 0; s < signals.size(); ++s) {
    Measurement& m = recording.measurements.emplace_back();
    m.signal = signals[s];
    m.values = columns[2 + s].values;
    m.sigma = usual_noise(signals[s]);
    m.noise = NoiseSource::given;
  }
  return recording;
}

/// The paper's x axis in 0.7 s of a 10 V step, with the gear ringing at its end.
inline Recording recorded_step(const Model<double>& truth, std::uint64_t seed = 2,
                               bool noisy = true) {
  Recording recording = recorded(truth, StepMotion{10.0, 0.0}, 0.7, seed,
                                 {Signal::velocity, Signal::acceleration}, noisy);
  recording.name = "step";
  return recording;
}

/// A slide with a linear motor: a force of 40 N per volt on 20 kg, hardly any friction. Quick to
/// simulate, and every effect of the arm stands out.
inline Model<double> slide() {
  Model<double> model = driven_mass(20.0);
  model.axis.K_f = 40.0;
  model.axis.B_a = 30.0;
  return model;
}

/// The paper's axis without its gear, with an ideal power stage that is rarely at its limit.
inline Model<double> motor_axis() {
  Model<double> model = paper_axis();
  model.structure.drive = Drive::current_source;
  model.structure.transmission = Transmission::rigid;
  model.axis.V_L = 8.0;
  return model;
}

/// Two motions of 1.2 s to and fro, at several levels, that differ.
inline Motion fit_motion(double volts = 6.0) {
  return LevelsMotion{{volts, -volts, -0.7 * volts, volts, 0.3 * volts, -0.5 * volts}, 0.2};
}
inline Motion validate_motion(double volts = 6.0) {
  return LevelsMotion{{0.8 * volts, -0.9 * volts, -0.4 * volts, volts, 0.3 * volts, -0.6 * volts},
                      0.2};
}

/// Frees a quantity on a logarithmic scale from `initial`.
/// A job with one recording to fit and one to validate of `truth`, by somebody who takes it for
/// `declared`. The free parameters start at the values of the latter.
inline Job two_recordings(const Model<double>& truth, const Model<double>& declared,
                          const std::vector<const char*>& free, double volts = 6.0,
                          const std::vector<Signal>& signals = {Signal::velocity,
                                                                Signal::acceleration},
                          std::uint64_t seed = 1) {
  Job job;
  job.model = declared;
  job.options.threads = 1;
  job.recordings = {recorded(truth, fit_motion(volts), 1.2, 2 * seed, signals),
                    recorded(truth, validate_motion(volts), 1.2, 2 * seed + 1, signals)};
  job.recordings[1].name = "validate";
  job.recordings[1].role = Role::validate;
  Model<double> values = declared;
  for (const char* name : free)
    job.free.push_back(free_parameter(name, *members(values)[quantity_index(name)]));
  return job;
}

/// What a fit that ends at the initial values hands over, without their uncertainties.
inline FitResult result_at_start(const Job& job) {
  const ParameterSpace space(job);
  FitResult result;
  result.verdict.kind = FitVerdict::Kind::usable;
  std::vector<double> values;
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    values.push_back(job.free[i].initial);
    result.parameters.push_back({job.free[i].id(), job.free[i].initial, {}});
  }
  const Eigen::VectorXd u = space.internal(values);
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    result.recordings.emplace_back();
    result.recordings.back().free_running = simulate_recording(job, space, r, u.data(), {});
  }
  result.at_solution = std::make_shared<const Linearization>(linearize(job, space, u, 0.0));
  return result;
}

/// The inputs as recorded with noise of `sigma` (V) that never reached the axis.
inline void add_input_noise(Job& job, double sigma, std::uint64_t seed = 1) {
  Normal normal(1000 + seed);
  for (Recording& r : job.recordings) {
    Schedule noisy;
    for (const double t : r.times) noisy.append(t, r.command.value_at(t) + sigma * normal());
    r.command = noisy;
    r.command_sigma = sigma;
  }
}

}  // namespace axisfit
