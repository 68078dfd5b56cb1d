// Jobs with simulated recordings, for the programs that count how often a fit is right.
#pragma once

#include <string>

#include "fit/data/job.h"
#include "sim/rig.h"

namespace axisfit {

/// A recording to be fitted, of all signals that the options ask for, with the rig's noise.
inline Recording simulated(const Rig& rig, const Motion& motion, const RecordingOptions& options) {
  const std::vector<Column> columns = record(rig, motion, options);
  Recording recording;
  recording.name = "simulated";
  recording.times = columns[0].values;
  recording.command = schedule_from_samples(recording.times, columns[1].values);
  for (std::size_t s = 0; s < options.signals.size(); ++s) {
    Measurement m;
    m.signal = options.signals[s];
    m.values = columns[2 + s].values;
    m.sigma = rig.noise[index_of(m.signal)];
    m.noise = NoiseSource::given;
    recording.measurements.push_back(std::move(m));
  }
  return recording;
}

/// A positive quantity, started at `factor` times its value in the model.
inline FreeParameter free_parameter(Model<double> model, const std::string& name,
                                    double factor = 1.0) {
  FreeParameter p;
  p.quantity = quantity_index(name);
  p.initial = *members(model)[p.quantity] * factor;
  p.lower = p.initial / 100.0;
  p.upper = p.initial * 100.0;
  return p;
}

}  // namespace axisfit
