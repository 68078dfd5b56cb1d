// A rig whose readings are easily computed, and what to record of it.
#pragma once

#include <utility>
#include <vector>

#include "sim/rig.h"
#include "tests/sim/axes.h"

namespace axisfit {

/// A mass of 10 kg that a force of 1 N per volt drives.
inline Rig rig_of_mass() {
  Rig rig;
  rig.model = driven_mass(10.0);
  rig.model.axis.K_f = 1.0;
  return rig;
}

/// A second, at this rate (Hz).
inline RecordingOptions one_second(double rate, std::vector<Signal> signals) {
  RecordingOptions options;
  options.duration = 1.0;
  options.rate = rate;
  options.signals = std::move(signals);
  return options;
}

}  // namespace axisfit
