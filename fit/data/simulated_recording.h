// A recording as the model simulates it.
#pragma once

#include <vector>

#include "sim/mode.h"

namespace axisfit {

/// The simulated axis at one sample, SI, forces on the arm side.
struct Sample {
  double command = 0.0;         ///< V
  double position = 0.0;        ///< m, of the arm
  double velocity = 0.0;        ///< m/s, of the arm
  double motor_angle = 0.0;     ///< rad
  double current = 0.0;         ///< A
  double drive_force = 0.0;     ///< N
  double gear_force = 0.0;      ///< N; of a rigid transmission the drive force
  double observer_force = 0.0;  ///< N, zero when free-running
};

/// The simulated signals of a recording, and the axis itself.
struct SimulatedRecording {
  bool finished = false;
  /// Per measurement, in the recording's order, one value per sample, in the signal's unit.
  std::vector<std::vector<double>> simulated;
  std::vector<Sample> samples;
  std::vector<ModeChange> modes;  ///< that the axis passed through, the first included
  int events = 0;
};

}  // namespace axisfit
