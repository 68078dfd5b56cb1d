// A small job with a known truth, for the tests of the fit.
#pragma once

#include "fit/job.h"
#include "sim/rig.h"
#include "tests/sim/axes.h"

namespace axisfit {

/// The paper's x axis, recorded for 0.7 s by a rig with the given noise (velocity m/s, acceleration
/// m/s^2): a 10 V step with the gear ringing at its end.
inline Recording recorded_step(const Model<double>& truth, double velocity_noise,
                               double acceleration_noise, std::uint64_t seed = 2) {
  Rig rig;
  rig.model = truth;
  rig.noise[index_of(Signal::velocity)] = velocity_noise;
  rig.noise[index_of(Signal::acceleration)] = acceleration_noise;
  RecordingOptions options;
  options.duration = 0.7;
  options.seed = seed;
  options.signals = {Signal::velocity, Signal::acceleration};
  const Table table = record(rig, StepMotion{10.0, 0.0}, options);
  Recording recording;
  recording.name = "step";
  recording.times = table.columns[0].values;
  recording.command = schedule_from_samples(recording.times, table.columns[1].values);
  recording.measurements = {{Signal::velocity, table.columns[2].values, 2e-3, true, true},
                            {Signal::acceleration, table.columns[3].values, 0.05, true, true}};
  return recording;
}

/// Frees a quantity on a logarithmic scale from `initial`.
inline FreeParameter free_parameter(const char* name, double initial) {
  FreeParameter p;
  p.quantity = find_quantity(name)->index;
  p.initial = initial;
  p.lower = initial / 100.0;
  p.upper = initial * 100.0;
  return p;
}

}  // namespace axisfit
