// A job that is fitted in a tenth of a second: two parameters of the x axis, from 0.3 s.
#pragma once

#include <fstream>
#include <string>

#include "apps/axis_file.h"
#include "sim/rig.h"
#include "tests/apps/files.h"

namespace axisfit {

/// Writes short.csv, a recording of the shipped x axis at two levels, and judge.csv, one with the
/// velocity alone.
inline void write_recordings(const TempFolder& folder) {
  Diagnostics diagnostics;
  const auto rig = read_axis_file(AXISFIT_CONFIGS "/axes/x.yaml", diagnostics);
  diagnostics.throw_if_any();
  RecordingOptions options;
  options.duration = 0.3;
  options.rate = 500.0;
  options.signals = {Signal::velocity, Signal::motor_current};
  std::ofstream out(folder.path("short.csv"));
  write_csv(out, record(*rig, LevelsMotion{{6.0, -4.0}, 0.15}, options), 9);
  options.seed = 2;
  options.signals = {Signal::velocity};
  std::ofstream judge(folder.path("judge.csv"));
  write_csv(judge, record(*rig, LevelsMotion{{-5.0, 5.0}, 0.1}, options), 9);
}

/// The job. Its axis is the shipped one; `fit` becomes the value of the key fit.
inline std::string fit_job(const std::string& fit = "{}",
                           const std::string& axis = AXISFIT_CONFIGS "/axes/x.yaml") {
  return "axis: '" + axis + R"('
recordings:
  - file: short.csv
    time: {column: time_s, unit: s}
    signals:
      command: {column: command_v, unit: V}
      velocity: {column: velocity_mps, unit: m/s, sigma: 2 mm/s}
      motor_current: {column: motor_current_a, unit: A, sigma: 20 mA, fit: false}
  - file: judge.csv
    role: validate
    time: {column: time_s, unit: s}
    signals:
      command: {column: command_v, unit: V}
      velocity: {column: velocity_mps, unit: m/s}
free:
  B_a: {initial: 100 N s/m}
  V_L: {initial: 4 V}
fit: )" + fit +
         "\n";
}

}  // namespace axisfit
