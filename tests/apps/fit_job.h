// Jobs that are fitted in a tenth of a second, with recordings made for them.
#pragma once

#include <string>
#include <vector>

#include "io/config/axis_file.h"
#include "io/recording/csv.h"
#include "sim/rig.h"
#include "tests/apps/files.h"

namespace axisfit {

/// How many times as long a program takes, in tests that stop it by the clock.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr int kSlower = 10;
#else
inline constexpr int kSlower = 1;
#endif

/// Records a rig at some levels of the command.
inline Table record_levels(const Rig& rig, const LevelsMotion& motion, double duration,
                           const std::vector<Signal>& signals, double rate,
                           std::uint64_t seed = 1) {
  RecordingOptions options;
  options.duration = duration;
  options.rate = rate;
  options.seed = seed;
  options.signals = signals;
  return {"", record(rig, motion, options), {}};
}

/// The same of an axis file's rig.
inline Table record_levels(const std::string& axis, const LevelsMotion& motion, double duration,
                           const std::vector<Signal>& signals, double rate,
                           std::uint64_t seed = 1) {
  Diagnostics diagnostics;
  const auto rig = read_axis_file(axis, diagnostics);
  diagnostics.throw_if_any();
  return record_levels(*rig, motion, duration, signals, rate, seed);
}

/// Writes short.csv, a recording of the shipped x axis at two levels, and judge.csv, one with the
/// velocity alone.
inline void write_recordings(const TempFolder& folder) {
  const std::string axis = AXISFIT_CONFIGS "/axes/x.yaml";
  const LevelsMotion fitted{{6.0, -4.0}, 0.15}, judged{{-5.0, 5.0}, 0.1};
  folder.write("short.csv",
               record_levels(axis, fitted, 0.3, {Signal::velocity, Signal::motor_current}, 500.0),
               9);
  folder.write("judge.csv", record_levels(axis, judged, 0.3, {Signal::velocity}, 500.0, 2), 9);
}

/// A job of two parameters of the x axis. Its axis is the shipped one; `fit` becomes the value of
/// the key fit.
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

/// Writes plain.yaml, a mass that a force drives, and two recordings of one that has dry friction,
/// too.
inline void write_rubbing_mass(const TempFolder& folder) {
  const std::string plain =
      "drive: force_source\ntransmission: rigid\n"
      "parameters: {K_f: 10 N/V, M: 4 kg, B_a: 8 N s/m}\n"
      "instruments: {velocity: {noise: 2 mm/s}, acceleration: {noise: 0.05 m/s^2}}\n";
  folder.write("plain.yaml", plain);
  const std::string rubbing =
      folder.write("rubbing.yaml", plain + "effects: {coulomb_friction: {F_c: 6 N}}\n");
  const std::vector<Signal> signals{Signal::velocity, Signal::acceleration};
  folder.write("fitted.csv",
               record_levels(rubbing, {{3.0, -4.0, 1.5, 0.0}, 0.4}, 2.0, signals, 250.0), 9);
  folder.write("judged.csv",
               record_levels(rubbing, {{-2.0, 3.5, -1.0}, 0.5}, 1.5, signals, 250.0, 2), 9);
}

/// The job on them. Without a recording to validate, blocks have to be held out.
inline std::string rubbing_job(bool validate = true) {
  const auto recording = [](const std::string& file, const std::string& role) {
    return "  - {file: " + file + ", role: " + role +
           ", time: {column: time_s, unit: s}, signals: {\n"
           "      command: {column: command_v, unit: V},\n"
           "      velocity: {column: velocity_mps, unit: m/s, sigma: 2 mm/s},\n"
           "      acceleration: {column: acceleration_mps2, unit: m/s^2, fit: false}}}\n";
  };
  return "axis: plain.yaml\nrecordings:\n" + recording("fitted.csv", "fit") +
         (validate ? recording("judged.csv", "validate") : "") +
         "free: {M: {initial: 10 kg}, B_a: {initial: 3 N s/m}}\n";
}

}  // namespace axisfit
