#include "io/config/job_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fit/data/noise.h"
#include "io/config/config.h"
#include "io/recording/csv.h"
#include "tests/apps/files.h"

namespace axisfit {
namespace {

using Values = std::vector<double>;

// A mass with friction that a recorded signal drives.
constexpr const char* kMass = R"(name: mass
drive: force_source
transmission: rigid
parameters:
  K_f: 2 N/V
  M: 4 kg
  B_a: 8 N s/m
effects:
  coulomb_friction: {F_c: 1 N}
)";

// The same behind an electric drive.
constexpr const char* kDriven = R"(name: driven
drive: current_source
transmission: rigid
parameters:
  {K_m: 1 N m/A, J_m: 0 kg m^2, B_m: 0 N m s/rad, K_t: 1 V s/rad, r_g: 1 m, M: 4 kg, T_z: 0 s,
   T_p: 1 s, T_r: 1 ms, K_1: 1, K_2: 1, K_i: 1 A/V, V_L: 1 V, B_a: 8 N s/m}
)";

// Lines count: the messages below name them.
constexpr const char* kJob = R"(axis: mass.yaml
recordings:
  - file: data.csv
    time: {column: t_ms, unit: ms}
    signals:
      command: {column: u, unit: V}
      velocity: {column: v, unit: m/s, sigma: 1 mm/s}
free:
  M: {}
)";

constexpr std::size_t kRows = 14;

// Columns with numbers that are exact; the samples are not evenly spaced.
struct Data {
  Values t_ms, u, v, x, f;
  Data() {
    double t = -8.0;
    for (std::size_t i = 0; i < kRows; ++i) {
      const double s = static_cast<double>(i);
      t_ms.push_back(t);
      t += i % 3 == 0 ? 8.0 : 4.0;
      u.push_back(i < 2 ? 0.5 : i < 9 ? -3.0 : 2.0);
      v.push_back(1.0 + 0.25 * s - 0.5 * s * s);
      x.push_back(0.125 * s);
      f.push_back(7.0 + s);
    }
  }
  std::vector<Column> columns() const {
    return {{"t_ms", t_ms}, {"u", u}, {"v", v}, {"x", x}, {"f", f}};
  }
};

Values times_s() {
  Values times = Data().t_ms;
  for (double& t : times) t *= 1e-3;
  return times;
}

// Writes vectors, which may differ in length, as a MAT-file.
void write_mat(const std::string& path, const std::vector<Column>& columns) {
  mat_t* mat = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  ASSERT_NE(mat, nullptr);
  for (const Column& c : columns) {
    Values values = c.values;
    std::array<std::size_t, 2> size{values.size(), 1};
    matvar_t* variable =
        Mat_VarCreate(c.name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0);
    EXPECT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
  }
  Mat_Close(mat);
}

class JobFileTest : public ::testing::Test {
 protected:
  JobFileTest() {
    folder_.write("mass.yaml", kMass);
    folder_.write("driven.yaml", kDriven);
    write_data("data.csv", Data().columns());
  }

  void write_data(const std::string& name, std::vector<Column> columns) {
    Table table;
    table.columns = std::move(columns);
    folder_.write(name, table);
  }

  JobFile read(const std::string& text, const std::string& data_directory = {}) {
    return read_job_file(folder_.write("job.yaml", text), data_directory);
  }

  std::string errors(const std::string& text, const std::string& data_directory = {}) {
    try {
      read(text, data_directory);
    } catch (const ConfigError& error) {
      return folder_.without_path(error.what());
    }
    return "";
  }

  /// The errors when one piece of the job is another.
  std::string errors_with(const std::string& from, const std::string& to) {
    return errors(replaced(kJob, from, to));
  }

  /// The job with more lines for its recording.
  static std::string with_lines(const std::string& lines) {
    return replaced(kJob, "  - file: data.csv\n", "  - file: data.csv\n" + lines);
  }

  TempFolder folder_;
};

using Overrides = std::vector<std::pair<std::size_t, double>>;

TEST_F(JobFileTest, ReadsTheShippedPaperJob) {
  const JobFile file = read_job_file(AXISFIT_CONFIGS "/jobs/paper.yaml");
  EXPECT_EQ(file.rig.name, "x axis of the Automatix AID 600");
  EXPECT_EQ(file.axis_file, AXISFIT_CONFIGS "/axes/x.yaml");
  const Job& job = file.job;
  EXPECT_EQ(job.model.structure.drive, Drive::velocity_loop);
  EXPECT_EQ(job.model.axis.M, 146.0);

  ASSERT_EQ(job.recordings.size(), 1u);
  const Recording& step = job.recordings.front();
  EXPECT_EQ(step.name, "step");
  EXPECT_EQ(step.file, "../../testdata/clean-fit.csv");
  EXPECT_EQ(step.role, Role::fit);
  EXPECT_EQ(step.initial_state, InitialState::given);
  EXPECT_TRUE(step.score_initial_samples);
  EXPECT_TRUE(step.overrides.empty());
  EXPECT_FALSE(step.acceleration_at_standstill);
  ASSERT_EQ(step.times.size(), 2501u);
  EXPECT_EQ(step.times.front(), 0.0);
  EXPECT_EQ(step.times[1], 0.001);
  EXPECT_EQ(step.times.back(), 2.5);
  EXPECT_EQ(step.command.times, (Values{0.0, 1.5}));
  EXPECT_EQ(step.command.values, (Values{10.0, 0.0}));

  ASSERT_EQ(step.measurements.size(), 2u);
  EXPECT_EQ(step.measurements[0].signal, Signal::velocity);
  EXPECT_DOUBLE_EQ(step.measurements[0].sigma, 0.002);
  EXPECT_EQ(step.measurements[0].values.front(), 0.000969287364);
  EXPECT_EQ(step.measurements[1].signal, Signal::acceleration);
  EXPECT_DOUBLE_EQ(step.measurements[1].sigma, 0.05);
  for (const Measurement& m : step.measurements) {
    EXPECT_EQ(m.values.size(), 2501u);
    EXPECT_EQ(m.noise, NoiseSource::given);
    EXPECT_TRUE(m.fitted);
  }
  // The arm rests at the end.
  EXPECT_TRUE(step.measurements[0].excluded.empty());
  EXPECT_TRUE(step.measurements[1].counts(1800));
  EXPECT_FALSE(step.measurements[1].counts(2400));

  const std::vector<std::pair<const char*, double>> free{
      {"V_L", 8.0}, {"B_a", 60.0}, {"b_g", 5000.0}, {"k_g", 1.5e6}, {"T_p", 0.1}};
  ASSERT_EQ(job.free.size(), free.size());
  for (std::size_t i = 0; i < free.size(); ++i) {
    const FreeParameter& p = job.free[i];
    EXPECT_EQ(p.quantity, quantity_index(free[i].first));
    EXPECT_DOUBLE_EQ(p.initial, free[i].second);
    const Quantity& quantity = quantity_list()[p.quantity].quantity;
    EXPECT_EQ(p.lower, quantity.lower);
    EXPECT_EQ(p.upper, quantity.upper);
    EXPECT_EQ(p.scale, quantity.lower > 0.0 ? Scale::logarithmic : Scale::from_zero);
    EXPECT_FALSE(p.recording.has_value());
    EXPECT_FALSE(p.prior.has_value());
  }

  const FitOptions defaults;
  EXPECT_EQ(job.options.criterion, Criterion(FreeRun{}));
  EXPECT_EQ(job.options.continuation, Continuation{});
  EXPECT_EQ(job.options.loss, Loss::squares);
  EXPECT_EQ(job.options.max_iterations, defaults.max_iterations);
  EXPECT_EQ(job.options.starts, 1);
  EXPECT_EQ(job.options.seed, 1u);
}

TEST_F(JobFileTest, KeepsIrregularSampleTimes) {
  const JobFile file = read(kJob);
  const Recording& recording = file.job.recordings.front();
  EXPECT_EQ(recording.times, times_s());
  EXPECT_EQ(recording.name, "data");
  EXPECT_EQ(recording.command.times, (Values{times_s()[0], times_s()[2], times_s()[9]}));
  EXPECT_EQ(recording.command.values, (Values{0.5, -3.0, 2.0}));
  EXPECT_EQ(recording.measurements.front().values, Data().v);
}

TEST_F(JobFileTest, ColumnsHaveUnitSignAndFactor) {
  const std::string text =
      replaced(replaced(kJob, "{column: u, unit: V}", "{column: u, unit: mV, sign: -1}"),
               "{column: v, unit: m/s, sigma: 1 mm/s}",
               "{column: v, unit: mm/s, sign: -1, factor: 4, sigma: 1 mm/s, fit: true}\n"
               "      position: {column: x, unit: cm, factor: 50 %, sigma: 2 um, fit: false}");
  const JobFile file = read(text);
  const Recording& recording = file.job.recordings.front();
  ASSERT_EQ(recording.measurements.size(), 2u);
  const Measurement &position = recording.measurements[0], &velocity = recording.measurements[1];
  EXPECT_EQ(position.signal, Signal::position);
  EXPECT_FALSE(position.fitted);
  EXPECT_DOUBLE_EQ(position.sigma, 2e-6);
  EXPECT_TRUE(velocity.fitted);
  for (std::size_t i = 0; i < kRows; ++i) {
    EXPECT_DOUBLE_EQ(position.values[i], Data().x[i] * 0.5 * 0.01);
    EXPECT_DOUBLE_EQ(velocity.values[i], Data().v[i] * -4.0 * 0.001);
  }
  EXPECT_DOUBLE_EQ(recording.command.values[0], -0.0005);
}

TEST_F(JobFileTest, TrimKeepsCommandsFromBefore) {
  const JobFile file = read(with_lines("    trim: {from: 8 ms, to: 1.0 s}\n"));
  const Recording& all = file.job.recordings.front();
  Values kept = times_s();
  kept.erase(kept.begin(), kept.begin() + 3);
  EXPECT_EQ(all.times, kept);
  EXPECT_EQ(all.command.times.front(), times_s()[0]);
  EXPECT_EQ(all.command.values, (Values{0.5, -3.0, 2.0}));
  EXPECT_EQ(all.measurements.front().values.size(), 11u);
  EXPECT_EQ(all.measurements.front().values.front(), Data().v[3]);
}

TEST_F(JobFileTest, TrimLeavesOutWhatComesAfter) {
  const std::string to = std::to_string(Data().t_ms[9]) + " ms";
  const JobFile file = read(with_lines("    trim: {to: " + to + "}\n"));
  const Recording& recording = file.job.recordings.front();
  EXPECT_EQ(recording.times.size(), 10u);
  EXPECT_EQ(recording.times.back(), times_s()[9]);  // the limit belongs to it
  EXPECT_EQ(recording.measurements.front().values.size(), 10u);
  EXPECT_EQ(
      errors(with_lines("    trim: {from: 1 s}\n")),
      "job.yaml:4:11: only 0 samples of 14, from -0.008 s to 0.064 s, remain: at least 10 are "
      "needed");
  EXPECT_EQ(errors(with_lines("    trim: {from: 1, until: 2 s}\n")),
            "job.yaml:4:18: from needs a unit, for example '1 s'\n"
            "job.yaml:4:21: unknown key 'until'; known keys: from, to");
}

TEST_F(JobFileTest, ATrimmedRecordingOnTheEpochIsTheOneFromZero) {
  // Multiples of 1/64 s are exact at 1.7e9 s, too.
  const auto read_from = [&](double start) {
    Table table;
    table.columns = Data().columns();
    for (std::size_t i = 0; i < kRows; ++i)
      table.columns[0].values[i] = start + static_cast<double>(i) / 64.0;
    folder_.write("data.csv", table);
    const std::string from = fmt::format("    trim: {{from: {} s}}\n", start + 0.0625);
    return read(replaced(with_lines(from), "unit: ms", "unit: s")).job.recordings.front();
  };
  const Recording zero = read_from(0.0), epoch = read_from(1.7e9);
  EXPECT_EQ(zero.times.front(), 0.0625);
  EXPECT_EQ(zero.command.times.front(), 0.0);
  EXPECT_EQ(epoch.times, zero.times);
  EXPECT_EQ(epoch.command.times, zero.command.times);
  EXPECT_EQ(epoch.command.values, zero.command.values);
  EXPECT_EQ(epoch.measurements.front().values, zero.measurements.front().values);
}

TEST_F(JobFileTest, AFitNeedsMoreValuesThanParameters) {
  const auto errors_of_ten_values = [&](const std::string& free) {
    const std::string to = fmt::format("    trim: {{to: {} ms}}\n", Data().t_ms[9]);
    return errors(replaced(with_lines(to), "M: {}", free));
  };
  const std::string nine =
      "M: {}\n  B_a: {}\n  coulomb_friction.F_c: {}\n  velocity.bias: {}\n  velocity.gain: {}\n"
      "  velocity.delay: {}\n  velocity.lag: {}\n  initial.y0: {}\n  initial.y1: {}";
  EXPECT_EQ(errors_of_ten_values(nine), "");
  EXPECT_EQ(errors_of_ten_values(nine + "\n  K_f: {}"),
            "job.yaml:10:3: 10 values, priors included, cannot determine 10 parameters: free fewer "
            "parameters or fit more samples");
}

TEST_F(JobFileTest, LimitsOfTheMachineAreRead) {
  EXPECT_FALSE(read(kJob).job.limits.speed);
  const JobFile file =
      read(std::string(kJob) + "limits: {travel: [-1 cm, 1.2 m], speed: 90 cm/s}\n");
  EXPECT_DOUBLE_EQ(file.job.limits.lowest.value(), -0.01);
  EXPECT_DOUBLE_EQ(file.job.limits.highest.value(), 1.2);
  EXPECT_DOUBLE_EQ(file.job.limits.speed.value(), 0.9);
  EXPECT_FALSE(file.job.limits.command);
}

TEST_F(JobFileTest, NoiseIsEstimatedFromTheSamplesThatAreKept) {
  Data data;
  for (std::size_t i = 0; i < kRows; ++i) data.v[i] = i % 2 == 0 ? 0.5 : -0.5;
  write_data("data.csv", data.columns());
  const JobFile file = read(replaced(kJob, ", sigma: 1 mm/s", ""));
  const Measurement& velocity = file.job.recordings.front().measurements.front();
  EXPECT_EQ(velocity.noise, NoiseSource::differences);
  EXPECT_EQ(velocity.sigma, noise_from_differences(velocity.values));
  EXPECT_GT(velocity.sigma, 0.0);
  const JobFile fit = read(replaced(kJob, "sigma: 1 mm/s", "sigma: fit"));
  const Measurement& same = fit.job.recordings.front().measurements.front();
  EXPECT_EQ(same.noise, NoiseSource::fit);
  EXPECT_EQ(same.sigma, velocity.sigma);

  for (double& v : data.v) v = 1.0;
  write_data("data.csv", data.columns());
  EXPECT_EQ(errors_with(", sigma: 1 mm/s", ""),
            "job.yaml:7:17: the noise of velocity cannot be estimated from these samples: give its "
            "sigma, for example 'sigma: 0.01 m/s'");
}

TEST_F(JobFileTest, TheNoiseOfAnInputIsGivenOrOfAForceSourceEstimated) {
  Data data;
  for (std::size_t i = 0; i < kRows; ++i)
    data.u[i] = std::sin(0.05 * double(i)) + (i % 2 == 0 ? 0.01 : -0.01);
  write_data("data.csv", data.columns());
  const Recording estimated = read(kJob).job.recordings.front();
  EXPECT_EQ(estimated.command_noise, NoiseSource::differences);
  EXPECT_EQ(estimated.command_sigma, noise_of_input(data.u));
  EXPECT_GT(estimated.command_sigma, 0.0);
  const std::string command = "command: {column: u, unit: V";
  for (const double volts : {0.0, 0.02}) {
    const Recording given =
        read(replaced(kJob, command, fmt::format("{}, sigma: {} V", command, volts)))
            .job.recordings.front();
    EXPECT_EQ(given.command_noise, NoiseSource::given);
    EXPECT_EQ(given.command_sigma, volts);
  }
  // A drive receives the set velocity that its controller sent.
  const Recording sent = read(replaced(kJob, "mass.yaml", "driven.yaml")).job.recordings.front();
  EXPECT_EQ(sent.command_sigma, 0.0);
  EXPECT_EQ(sent.command_noise, NoiseSource::given);
  const Recording force = read(replaced(kJob, command,
                                        "drive_force: {column: f, unit: kN, "
                                        "sigma: 2 N"))
                              .job.recordings.front();
  EXPECT_EQ(force.command_sigma, 2.0);
}

TEST_F(JobFileTest, WhatWasMeasuredRunsLinearlyBetweenItsSamples) {
  const auto hold_with = [&](const std::string& input) {
    return read(replaced(kJob, "command: {column: u, unit: V}", input))
        .job.recordings.front()
        .command.hold;
  };
  EXPECT_EQ(hold_with("command: {column: u, unit: V}"), Hold::zero_order);
  EXPECT_EQ(hold_with("command: {column: u, unit: V, hold: linear}"), Hold::linear);
  EXPECT_EQ(hold_with("drive_force: {column: f, unit: kN}"), Hold::linear);
  EXPECT_EQ(hold_with("drive_force: {column: f, unit: kN, hold: zero_order}"), Hold::zero_order);
  EXPECT_EQ(errors_with("command: {column: u, unit: V}", "command: {column: u, unit: V, hold: 2}"),
            "job.yaml:6:43: hold must be one of zero_order, linear, not '2'");
}

TEST_F(JobFileTest, ADriveForceReplacesTheCommandOfAForceSource) {
  const JobFile file =
      read(replaced(kJob, "command: {column: u, unit: V}", "drive_force: {column: f, unit: kN}"));
  const Recording& recording = file.job.recordings.front();
  EXPECT_EQ(recording.command.values.size(), kRows);
  EXPECT_DOUBLE_EQ(recording.command.values.front(), 7000.0);
  EXPECT_EQ(recording.overrides, (Overrides{{quantity_index("K_f"), 1.0}}));
  EXPECT_EQ(recording.measurements.size(), 1u);

  EXPECT_EQ(errors_with("      command: {column: u, unit: V}\n",
                        "      command: {column: u, unit: V}\n"
                        "      drive_force: {column: f, unit: N}\n"),
            "job.yaml:7:20: give either the command or the drive force, not both: each drives the "
            "axis");
  EXPECT_EQ(errors_with("      command: {column: u, unit: V}\n", ""),
            "job.yaml:6:7: the axis is driven by a command or a drive_force: name one of them, "
            "or the position_reference that its controller follows");
  EXPECT_EQ(errors(replaced(replaced(kJob, "mass.yaml", "driven.yaml"),
                            "      command: {column: u, unit: V}\n", "")),
            "job.yaml:6:7: the axis is driven by the command: name its column, or that of the "
            "position_reference that its controller follows");
}

// What the controller follows is simulated with it, or makes the command.
TEST_F(JobFileTest, AReferenceIsFollowedByTheController) {
  const char* const command = "command: {column: u, unit: V}";
  const std::string followed =
      replaced(kJob, command, "position_reference: {column: u, unit: mm, hold: linear}");
  const Job job = read(followed).job;
  EXPECT_TRUE(job.model.structure.closed_loop);
  const Schedule& reference = job.recordings.front().command;
  EXPECT_EQ(reference.meaning, Meaning::reference);
  EXPECT_EQ(reference.hold, Hold::linear);
  EXPECT_DOUBLE_EQ(reference.values.front(), 0.5e-3);
  EXPECT_EQ(read(followed + "  controller.k_p: {}\n").job.free.back().initial, 6.0);
  EXPECT_EQ(
      errors(std::string(kJob) + "  controller.k_p: {}\n"),
      "job.yaml:10:3: controller.k_p needs a recording with a position_reference whose loop is "
      "simulated");
  EXPECT_EQ(read(replaced(followed, "      velocity",
                          "      position: {column: x, unit: m}\n"
                          "      velocity"))
                .job.recordings.front()
                .command.meaning,
            Meaning::reference);

  const std::string computed = replaced(followed, "hold: linear", "loop: computed");
  EXPECT_EQ(
      errors(computed),
      "job.yaml:6:27: to compute the command of a position_reference the controller reads the "
      "encoder: name its column under position, or say 'loop: simulated'");
  const Job open = read(replaced(computed, "      velocity",
                                 "      position: {column: x, unit: m}\n"
                                 "      velocity"))
                       .job;
  EXPECT_FALSE(open.model.structure.closed_loop);
  EXPECT_EQ(open.recordings.front().command.meaning, Meaning::command);

  const std::string late =
      "T_d must be below 9 periods of the controller's commands, whose loop is simulated";
  EXPECT_EQ(errors(replaced(followed, "    time:", "    set: {T_d: 1 s}\n    time:")),
            "job.yaml:4:10: " + late);
  folder_.write("mass.yaml", replaced(kMass, "M: 4 kg", "M: 4 kg\n  T_d: 1 s"));
  EXPECT_EQ(errors(followed), "job.yaml:1:7: " + late);
}

// A PWM acts on its supply.
TEST_F(JobFileTest, ADutyOfASupplyIsAVoltage) {
  folder_.write("mass.yaml",
                "drive: motor_voltage\ntransmission: rigid\n"
                "parameters: {K_m: 1 N m/A, R: 2 ohm, r_g: 1 m, M: 4 kg, B_a: 8 N s/m}\n");
  const auto values = [&](const char* supply) {
    return read(replaced(kJob, "column: u, unit: V",
                         std::string("column: u, unit: \"%\", supply: ") + supply))
        .job.recordings.front()
        .command.values;
  };
  EXPECT_DOUBLE_EQ(values("24 V").front(), 0.12);
  EXPECT_DOUBLE_EQ(values("{column: x, unit: V}").front(), 0.005 * Data().x.front());
  folder_.write("mass.yaml", kMass);
  EXPECT_NE(read(replaced(kJob, "column: u, unit: V", "column: u, unit: \"%\", supply: 24 V"))
                .job.recordings.front()
                .command.values.size(),
            0u);
  folder_.write("mass.yaml",
                replaced(replaced(kMass, "force_source", "motor_current"), "N/V", "N/A"));
  EXPECT_EQ(
      errors(replaced(kJob, "column: u, unit: V", "column: u, unit: \"%\", supply: 24 V")),
      "job.yaml:6:47: a duty of a supply makes a voltage: the drive must be one that takes V");
}

TEST_F(JobFileTest, InitialStateFromData) {
  // A cubic, which the estimate follows exactly, in position and velocity.
  Data data;
  for (std::size_t i = 0; i < kRows; ++i) {
    const double t = 1e-3 * (data.t_ms[i] - data.t_ms[0]);
    data.x[i] = 0.5 + 2.0 * t - 30.0 * t * t;
    data.v[i] = 2.0 - 60.0 * t;
  }
  write_data("data.csv", data.columns());
  const std::string velocity = with_lines("    initial_state: data\n    initial_samples: 6\n");
  const JobFile from_velocity = read(velocity);
  const Recording& a = from_velocity.job.recordings.front();
  EXPECT_EQ(a.initial_state, InitialState::data);
  EXPECT_EQ(a.initial_samples, 6u);
  ASSERT_EQ(a.overrides.size(), 1u);
  EXPECT_EQ(a.overrides[0].first, quantity_index("initial.y1"));
  EXPECT_NEAR(a.overrides[0].second, 2.0, 1e-9);

  const std::string position = replaced(velocity, "velocity: {column: v, unit: m/s, sigma: 1 mm/s}",
                                        "position: {column: x, unit: m, sigma: 1 mm}");
  const JobFile from_position = read(position);
  const Recording& b = from_position.job.recordings.front();
  ASSERT_EQ(b.overrides.size(), 2u);
  EXPECT_EQ(b.overrides[0].first, quantity_index("initial.y0"));
  EXPECT_NEAR(b.overrides[0].second, 0.5, 1e-9);
  EXPECT_EQ(b.overrides[1].first, quantity_index("initial.y1"));
  EXPECT_NEAR(b.overrides[1].second, 2.0, 1e-9);

  // What is set by hand stays.
  const JobFile set = read(replaced(velocity, "initial_state: data",
                                    "initial_state: data\n    set: {initial.y1: 3 m/s}"));
  EXPECT_EQ(set.job.recordings.front().overrides, (Overrides{{quantity_index("initial.y1"), 3.0}}));

  EXPECT_EQ(errors(replaced(velocity, "velocity: {column: v, unit: m/s, sigma: 1 mm/s}",
                            "acceleration: {column: x, unit: m/s^2, sigma: 1 m/s^2}")),
            "job.yaml:8:7: initial_state: data needs a recorded position or velocity");
}

TEST_F(JobFileTest, UnscoredInitialSamplesMustLeaveSomeToScore) {
  const std::string text =
      with_lines("    score_initial_samples: false\n    initial_samples: 13\n");
  EXPECT_FALSE(read(text).job.recordings.front().score_initial_samples);
  EXPECT_EQ(errors(replaced(text, "13", "14")),
            "job.yaml:5:22: with 14 unscored initial samples, nothing of the 14 samples is left to "
            "score");
  EXPECT_EQ(errors(replaced(text, "    initial_samples: 13\n", "")),
            "job.yaml:3:5: with 20 unscored initial samples, nothing of the 14 samples is left to "
            "score");
}

TEST_F(JobFileTest, FiltersAndHoldsAreRead) {
  std::vector<Column> columns{{"t_ms", {}}, {"u", {}}, {"v", {}}};
  for (int i = 0; i < 300; ++i) {
    columns[0].values.push_back(i);
    columns[1].values.push_back(1.0);
    columns[2].values.push_back(std::sin(0.1 * (i - i % 4)));
  }
  write_data("data.csv", columns);
  const auto velocity = [&](const std::string& keys) {
    return read(replaced(kJob, "sigma: 1 mm/s", "sigma: 1 mm/s, " + keys))
        .job.recordings.front()
        .measurements.front();
  };
  const Measurement average = velocity("filter: {moving_average: 21, zero_phase: true}");
  EXPECT_EQ(average.filter, (Filter{Filter::Kind::moving_average, 21, 1, 0.25, true}));
  EXPECT_FALSE(average.counts(9));
  EXPECT_TRUE(average.counts(10));
  const Measurement butterworth = velocity("filter: {butterworth: {order: 3, cutoff: 50 Hz}}");
  EXPECT_EQ(butterworth.filter.kind, Filter::Kind::butterworth);
  EXPECT_EQ(butterworth.filter.order, 3);
  EXPECT_NEAR(butterworth.filter.cutoff, 0.05, 1e-12);
  EXPECT_FALSE(butterworth.filter.zero_phase);
  const Measurement held = velocity("hold: 4");
  EXPECT_EQ(held.hold, 4u);
  EXPECT_EQ(held.values[4], columns[2].values[4]);
  EXPECT_NE(held.values[5], columns[2].values[5]);
  EXPECT_TRUE(held.counts(4));
  EXPECT_FALSE(held.counts(5));
}

TEST_F(JobFileTest, AccelerationAtRestIsLeftOutUnlessKept) {
  std::vector<Column> columns{{"t_ms", {}}, {"u", {}}, {"v", {}}, {"a", {}}};
  for (int i = 0; i < 200; ++i) {
    const bool rests = i >= 100;
    const double row[] = {double(i), 1.0, rests ? 0.0 : 0.5, rests ? 0.2 : 1.0};
    for (std::size_t c = 0; c < 4; ++c) columns[c].values.push_back(row[c]);
  }
  write_data("data.csv", columns);
  const std::string text =
      replaced(kJob, "sigma: 1 mm/s}\n",
               "sigma: 1 mm/s}\n      acceleration: {column: a, unit: m/s^2, sigma: 1 cm/s^2}\n");
  const auto with = [&](const std::string& value) {
    return replaced(text, "  - file: data.csv\n",
                    "  - file: data.csv\n    acceleration_at_standstill: " + value + "\n");
  };
  for (const std::string& excluded : {text, with("exclude")}) {
    const Recording recording = read(excluded).job.recordings.front();
    EXPECT_TRUE(recording.measurements[0].counts(150));
    EXPECT_TRUE(recording.measurements[1].counts(50));
    EXPECT_FALSE(recording.measurements[1].counts(150));
  }
  EXPECT_TRUE(read(with("keep")).job.recordings.front().measurements[1].counts(150));
  EXPECT_EQ(errors(with("drop")),
            "job.yaml:4:33: acceleration_at_standstill must be one of exclude, keep, not 'drop'");
}

TEST_F(JobFileTest, OverridesHoldForTheirRecording) {
  const JobFile file = read(with_lines("    set: {B_a: 1 kN s/m, velocity.bias: 3 mm/s}\n"));
  EXPECT_EQ(file.job.recordings.front().overrides,
            (Overrides{{quantity_index("B_a"), 1000.0}, {quantity_index("velocity.bias"), 0.003}}));
  EXPECT_EQ(file.job.model.axis.B_a, 8.0);
  EXPECT_EQ(errors(with_lines("    set: {B_q: 1 kN s/m, K_m: 3 N m/A, F_s: -1 N}\n")),
            "job.yaml:4:11: unknown quantity 'B_q'; did you mean 'B_a'?\njob.yaml:4:26: K_m is not "
            "used by this axis, because of its drive or transmission\njob.yaml:4:45: F_s must lie "
            "between 0 N and 1e+05 N, not -1 N");
}

TEST_F(JobFileTest, OverridesMayNotMakeAnAxisThatCannotBeSimulated) {
  std::string axis = replaced(kDriven, "transmission: rigid", "transmission: backlash");
  axis = replaced(axis, "J_m: 0 kg m^2", "J_m: 1 kg m^2, H: 0 m, b_g: 1 N s/m, k_g: 1 N/m");
  folder_.write("mass.yaml", axis);
  EXPECT_EQ(errors(with_lines("    set: {J_m: 0 kg m^2}\n")),
            "job.yaml:4:10: J_m must be above zero with backlash: while the teeth are apart, the "
            "motor torque acts on J_m alone");
}

TEST_F(JobFileTest, AQuantityIsEitherFittedForAllOrSet) {
  const std::string text = with_lines("    set: {M: 5 kg}\n");
  EXPECT_EQ(errors(text),
            "job.yaml:10:6: M is fitted for all recordings but set for 'data': remove one, or use "
            "per_recording: true");
  const JobFile file = read(replaced(text, "M: {}", "M: {per_recording: true}"));
  ASSERT_EQ(file.job.free.size(), 1u);
  EXPECT_EQ(file.job.free[0].recording, 0u);
  EXPECT_EQ(file.job.free[0].initial, 5.0);  // of the recording
}

TEST_F(JobFileTest, PerRecordingFreesAQuantityOnceForEachFittedRecording) {
  // Others than the first, if only in time.
  for (const char* name : {"judge", "second"}) {
    Data data;
    for (double& t : data.t_ms) t += name[0] == 'j' ? 0.125 : 0.25;
    write_data(std::string(name) + ".csv", data.columns());
  }
  const std::string more =
      R"(  - {file: judge.csv, name: judge, role: validate, time: {column: t_ms, unit: ms},
     signals: {command: {column: u, unit: V}, velocity: {column: v, unit: m/s, sigma: 1 m/s}}}
  - {file: second.csv, name: second, set: {M: 6 kg}, time: {column: t_ms, unit: ms},
     signals: {command: {column: u, unit: V}, velocity: {column: v, unit: m/s, sigma: 1 m/s}}}
)";
  std::string text = replaced(kJob, "free:\n", more + "free:\n");
  text = replaced(text, "M: {}", "M: {per_recording: true}\n  B_a: {}");
  const JobFile file = read(text);
  ASSERT_EQ(file.job.recordings.size(), 3u);
  EXPECT_EQ(file.job.recordings[1].role, Role::validate);
  ASSERT_EQ(file.job.free.size(), 3u);
  EXPECT_EQ(file.job.free[0].recording, 0u);
  EXPECT_EQ(file.job.free[0].initial, 4.0);
  EXPECT_EQ(file.job.free[1].recording, 2u);
  EXPECT_EQ(file.job.free[1].initial, 6.0);
  EXPECT_FALSE(file.job.free[2].recording.has_value());

  EXPECT_EQ(errors(replaced(text, "name: second", "name: data")),
            "job.yaml:3:3: two recordings are called 'data': give them different names");
}

// Scale and bounds of a free parameter, from its entry in the job.
FreeParameter parameter(const JobFile& file) { return file.job.free.front(); }

TEST_F(JobFileTest, ScalesAndBoundsOfFreeParameters) {
  const double infinity = std::numeric_limits<double>::infinity();
  struct Case {
    const char* text;
    double initial, lower, upper;
    Scale scale;
  };
  using enum Scale;
  for (const Case& c : std::vector<Case>{
           {"M: {}", 4.0, 1e-3, 1e5, logarithmic},
           {"M: {initial: 200 g}", 0.2, 1e-3, 1e5, logarithmic},
           {"M: {bounds: [3 kg, 5 kg]}", 4.0, 3.0, 5.0, logarithmic},
           {"M: {bounds: [3 kg, 5 kg], scale: linear}", 4.0, 3.0, 5.0, linear},
           {"M: {scale: linear}", 4.0, 1e-3, 1e5, linear},
           {"B_a: {}", 8.0, 0.0, 1e6, from_zero},
           {"B_a: {bounds: [0 N s/m, 9 N s/m]}", 8.0, 0.0, 9.0, from_zero},
           {"B_a: {bounds: [1 N s/m, 9 N s/m]}", 8.0, 1.0, 9.0, logarithmic},
           {"B_a: {scale: log}", 8.0, 0.08, 1e6, logarithmic},
           {"B_a: {initial: 0 N s/m}", 0.0, 0.0, 1e6, linear},
           {"F_s: {}", 0.0, 0.0, 1e5, linear},
           {"F_s: {initial: 3 N, scale: log, bounds: [1 N, 9 N]}", 3.0, 1.0, 9.0, logarithmic},
           {"F_s: {initial: 3 N, scale: from_zero}", 3.0, 0.0, 1e5, from_zero},
           {"coulomb_friction.F_c: {}", 1.0, 0.0, 1e5, linear},
           {"velocity.gain: {}", 1.0, -1e6, 1e6, linear},
           {"initial.y1: {bounds: [-1 m/s, 1 m/s]}", 0.0, -1.0, 1.0, linear},
           {"T_d: {initial: 2 ms, bounds: [0 s, 9 ms]}", 0.002, 0.0, 0.009, linear},
       }) {
    SCOPED_TRACE(c.text);
    ASSERT_LT(c.upper, infinity);
    const FreeParameter p = parameter(read(replaced(kJob, "M: {}", c.text)));
    EXPECT_DOUBLE_EQ(p.initial, c.initial);
    EXPECT_DOUBLE_EQ(p.lower, c.lower);
    EXPECT_DOUBLE_EQ(p.upper, c.upper);
    EXPECT_EQ(p.scale, c.scale);
  }
}

TEST_F(JobFileTest, Priors) {
  const FreeParameter p =
      parameter(read(replaced(kJob, "M: {}", "M: {prior: {mean: 3900 g, sigma: 0.1 kg}}")));
  ASSERT_TRUE(p.prior.has_value());
  EXPECT_DOUBLE_EQ(p.prior->mean, 3.9);
  EXPECT_DOUBLE_EQ(p.prior->sigma, 0.1);
  EXPECT_EQ(errors_with("M: {}", "M: {prior: {mean: 3900, sgima: 0.1 kg}}"),
            "job.yaml:9:21: mean needs a unit, for example '3900 kg'\n"
            "job.yaml:9:27: unknown key 'sgima'; did you mean 'sigma'?");
}

TEST_F(JobFileTest, EffectsOfTheJobAddToThoseOfTheAxis) {
  const std::string text = std::string(kJob) + "effects: {constant_force: {F_0: 3 N}}\n";
  const JobFile file = read(replaced(text, "M: {}", "constant_force.F_0: {bounds: [0 N, 9 N]}"));
  EXPECT_EQ(file.job.model.structure.effects.count(), 2u);
  EXPECT_EQ(file.rig.model.structure.effects.count(), 2u);
  EXPECT_EQ(parameter(file).initial, 3.0);
  EXPECT_EQ(errors_with("M: {}", "constant_force.F_0: {}"),
            "job.yaml:9:3: constant_force.F_0 belongs to an effect that is not active: add it to "
            "the axis or job, as in 'effects: {constant_force: {F_0: ...}}'");
  EXPECT_EQ(errors(std::string(kJob) + "effects: {quadratic_darg: {c: 3 N}, constant_force: {}}\n"),
            "job.yaml:10:11: unknown key 'quadratic_darg'; did you mean 'quadratic_drag'?\n"
            "job.yaml:10:53: key 'F_0' is missing in constant_force");
}

TEST_F(JobFileTest, ReadsEveryOptionOfTheFit) {
  const JobFile file = read(std::string(kJob) + R"(fit:
  observer: {fixed: 5 1/ms}
  loss: huber
  huber_width: 2.5
  max_iterations: 7
  starts: 3
  seed: 11
  spread: 2
  step: 1 ms
)");
  const FitOptions& options = file.job.options;
  EXPECT_DOUBLE_EQ(std::get<Tracking>(options.criterion).gain, 5000.0);
  EXPECT_EQ(options.loss, Loss::huber);
  EXPECT_EQ(options.huber_width, 2.5);
  EXPECT_EQ(options.max_iterations, 7);
  EXPECT_EQ(options.starts, 3);
  EXPECT_EQ(options.seed, 11u);
  EXPECT_EQ(options.spread, 2.0);
  EXPECT_DOUBLE_EQ(options.step, 1e-3);
}

TEST_F(JobFileTest, TheCriterionComesFromObserverAndHorizon) {
  const auto with = [&](const std::string& keys) {
    return read(std::string(kJob) + "fit: {" + keys + "}\n").job;
  };
  const Criterion whole = FreeRun{};
  EXPECT_EQ(with("observer: none").options.criterion, whole);
  EXPECT_FALSE(with("observer: none").options.continuation);
  EXPECT_EQ(with("horizon: whole").options.criterion, whole);
  EXPECT_FALSE(with("horizon: whole").choose_criterion);
  const Job windows = with("observer: none, horizon: 200 ms");
  EXPECT_DOUBLE_EQ(std::get<Windows>(windows.options.criterion).length, 0.2);
  EXPECT_FALSE(windows.options.is_continued());
  EXPECT_TRUE(with("horizon: 200 ms").options.is_continued());
  const Job first = with("initial_observer_gain: 20 1/s");
  EXPECT_EQ(first.options.criterion, whole);
  EXPECT_DOUBLE_EQ(first.options.continuation->start_gain, 20.0);
  EXPECT_TRUE(with("horizon: auto").choose_criterion);
  const Job either = with("observer: {fixed: 30 1/s}, horizon: auto");
  EXPECT_TRUE(either.choose_criterion);
  EXPECT_DOUBLE_EQ(std::get<Tracking>(either.options.criterion).gain, 30.0);
  EXPECT_FALSE(either.options.is_continued());
}

TEST_F(JobFileTest, MatAndCsvGiveTheSameJob) {
  write_mat(folder_.path("data.mat"), Data().columns());
  const JobFile csv = read(with_lines("    name: a\n"));
  const JobFile mat =
      read(replaced(with_lines("    name: a\n"), "file: data.csv", "file: data.mat"));
  const Recording &a = csv.job.recordings.front(), &b = mat.job.recordings.front();
  EXPECT_EQ(a.times, b.times);
  EXPECT_EQ(a.command.times, b.command.times);
  EXPECT_EQ(a.command.values, b.command.values);
  EXPECT_EQ(a.measurements.front().values, b.measurements.front().values);
  EXPECT_EQ(a.measurements.front().sigma, b.measurements.front().sigma);
}

TEST_F(JobFileTest, SignalsKeepTheirClocks) {
  std::string fast = "t,u\n", slow = "t;x;v\n";
  for (int i = 0; i < 40; ++i) fast += fmt::format("{},{}\n", 0.01 * i, i % 2);
  for (int i = 0; i < 15; ++i)
    slow += fmt::format("{};{};{}\n", 0.02 * i, 0.1 * i, i == 4 ? "" : std::to_string(i));
  folder_.write("fast.csv", fast);
  folder_.write("slow.csv", slow);
  const Recording recording = read(R"(axis: mass.yaml
recordings:
  - file: fast.csv
    time: {column: t, unit: s}
    signals:
      command: {column: u, unit: V}
      position: {column: x, unit: m, file: slow.csv, offset: 5 ms, sigma: 1 mm}
      velocity: {column: v, unit: m/s, file: slow.csv, time: {column: 1, unit: s}, sigma: 1 mm/s}
free:
  M: {}
)")
                                  .job.recordings[0];
  // Both clocks of what was measured, while the input is known.
  ASSERT_EQ(recording.times.size(), 29u);
  EXPECT_EQ(recording.command.times.size(), 40u);
  const Measurement &position = *recording.find(Signal::position),
                    &velocity = *recording.find(Signal::velocity);
  std::size_t positions = 0, velocities = 0;
  for (std::size_t i = 0; i < recording.times.size(); ++i) {
    const double t = recording.times[i];
    EXPECT_NE(position.counts(i), velocity.counts(i) || std::abs(t - 0.08) < 1e-9);
    positions += position.counts(i);
    velocities += velocity.counts(i);
    // Between its samples a signal is on a curve through them.
    EXPECT_NEAR(position.values[i], std::clamp(5.0 * (t - 0.005), 0.0, 1.4), 1e-12);
  }
  EXPECT_EQ(positions, 15u);
  EXPECT_EQ(velocities, 14u);
}

TEST_F(JobFileTest, MatFilesMayHoldColumnsThatDoNotFit) {
  const std::string text = replaced(kJob, "data.csv", "data.mat");
  Data data;
  data.v.pop_back();
  write_mat(folder_.path("data.mat"), data.columns());
  EXPECT_EQ(errors(text), "job.yaml:7:17: velocity has 13 values but the time has 14");
  data = Data();
  data.u.pop_back();
  write_mat(folder_.path("data.mat"), data.columns());
  EXPECT_EQ(errors(text), "job.yaml:6:16: command has 13 values but the time has 14");
  data = Data();
  data.v[4] = std::numeric_limits<double>::infinity();
  data.t_ms[5] = data.t_ms[4];
  data.x = {3.0};
  write_mat(folder_.path("data.mat"), data.columns());
  EXPECT_EQ(errors(text),
            "job.yaml:4:11: data.mat: row 6: time 0.016 s does not increase from 0.016 s: samples "
            "must be in order of time, without repeats\njob.yaml:7:26: data.mat: row 5: 'v' is not "
            "finite: trim the recording or remove the row");
  data.t_ms = Data().t_ms;
  write_mat(folder_.path("data.mat"), data.columns());
  EXPECT_EQ(errors(replaced(text, "column: v", "column: x")),
            "job.yaml:7:26: 'x' in data.mat is a scalar");
}

TEST_F(JobFileTest, RecordingsMayBeInAnotherFolder) {
  std::filesystem::create_directory(folder_.path("rig"));
  std::filesystem::rename(folder_.path("data.csv"), folder_.path("rig/data.csv"));
  const std::string nowhere =
      ": cannot be opened (No such file or directory); check the path and the permissions";
  EXPECT_EQ(errors(kJob), "job.yaml:3:11: data.csv" + nowhere);
  EXPECT_EQ(errors(kJob, folder_.path("rig")), "");
  EXPECT_EQ(errors_with("data.csv", "rig/data.csv"), "");
  EXPECT_EQ(errors_with("data.csv", folder_.path("rig/data.csv")), "");
  EXPECT_EQ(errors(kJob, folder_.path("none")), "job.yaml:3:11: none/data.csv" + nowhere);
}

TEST_F(JobFileTest, MistakesInTheAxisFileAreThoseOfTheJob) {
  EXPECT_EQ(errors_with("mass.yaml", "none.yaml"),
            "job.yaml:1:7: axis file none.yaml does not exist");
  EXPECT_EQ(errors_with("axis: mass.yaml\n", ""),
            "job.yaml:1:1: key 'axis' is missing in the file");
  EXPECT_EQ(errors_with("mass.yaml", "[mass.yaml]"), "job.yaml:1:7: axis must be text, not a list");
  folder_.write("mass.yaml", replaced(kMass, "4 kg", "4"));
  EXPECT_EQ(errors(std::string(kJob) + "fit: {starts: 0}\n"),
            "mass.yaml:6:6: M needs a unit, for example '4 kg'\n"
            "job.yaml:10:15: starts must be a whole number between 1 and 1000000, not '0'");
}

struct Mistake {
  const char* from;
  const char* to;
  const char* message;
};

TEST_F(JobFileTest, EveryMistakeIsNamedWithItsPlace) {
  for (const auto& [from, to, message] : std::vector<Mistake>{
           // The whole.
           {"free:\n  M: {}\n", "", "1:1: key 'free' is missing in the file"},
           {"free:\n", "fre: {}\nfree:\n", "8:1: unknown key 'fre'; did you mean 'free'?"},
           {"free:\n", "starts: 3\nfree:\n",
            "8:1: unknown key 'starts'; known keys: axis, effects, recordings, free, fit, "
            "limits"},
           // Recordings.
           {"  - file: data.csv\n    time: {column: t_ms, unit: ms}\n", "  - file: data.csv\n",
            "3:5: key 'time' is missing in entry 1 of recordings"},
           {"file: data.csv", "file: data.csv\n    rol: fit",
            "4:5: unknown key 'rol'; did you mean 'role'?"},
           {"file: data.csv", "file: data.csv\n    role: fitt",
            "4:11: role must be one of fit, validate, not 'fitt'; did you mean 'fit'?"},
           {"file: data.csv", "file: data.csv\n    role: validate",
            "3:3: no recording has the role fit: at least one must"},
           {"file: data.csv", "file: data.csv\n    initial_state: guess",
            "4:20: initial_state must be one of given, data, not 'guess'"},
           {"file: data.csv", "file: data.csv\n    initial_samples: 3",
            "4:22: initial_samples must be a whole number between 4 and 1000000, not '3'"},
           {"file: data.csv", "file: data.csv\n    score_initial_samples: no",
            "4:28: score_initial_samples must be true or false, not 'no'"},
           {"file: data.csv", "file: .", "3:11: : is a directory; give the path of a recording"},
           // Columns.
           {"column: v,", "column: w,", "7:26: no column 'w' in data.csv; it has t_ms, u, v, x, f"},
           {"column: t_ms", "column: tms",
            "4:20: no column 'tms' in data.csv; did you mean 't_ms'? It has t_ms, u, v, x, f"},
           {"column: u, ", "", "6:16: key 'column' is missing in command"},
           {"unit: ms", "unit: m", "4:32: 'm' cannot be converted to 's'; use for example 's'"},
           {"unit: m/s", "unit: V",
            "7:35: 'V' cannot be converted to 'm/s'; use for example 'm/s'"},
           {", unit: V", "", "6:16: key 'unit' is missing in command"},
           {"unit: V}", "unit: V, fit: false}", "6:37: unknown key 'fit'; did you mean 'file'?"},
           {"unit: V}", "unit: V, sigma: -1 V}", "6:44: sigma must be at least 0 V, not -1 V"},
           {"unit: V}", "unit: V, sign: 2}", "6:43: sign must be one of 1, -1, not '2'"},
           {"unit: V}", "unit: V, factor: 2 V}",
            "6:45: factor: 'V' cannot be used for a dimensionless quantity; use a plain number or "
            "'%'"},
           {"sigma: 1 mm/s", "sigma: 1", "7:47: sigma needs a unit, for example '1 m/s'"},
           {"sigma: 1 mm/s", "sigma: 0 mm/s",
            "7:47: sigma must be above zero: residuals are divided by it"},
           {"sigma: 1 mm/s", "sigma: -1 mm/s", "7:47: sigma must be at least 0 m/s, not -1 mm/s"},
           {"sigma: 1 mm/s", "fit: maybe, sigma: 1 mm/s",
            "7:45: fit must be true or false, not 'maybe'"},
           {"sigma: 1 mm/s", "fit: false, sigma: 1 mm/s",
            "6:7: nothing to fit: every signal has fit: false; remove it from one, or give the "
            "recording the role validate"},
           {"      velocity: {column: v, unit: m/s, sigma: 1 mm/s}\n", "",
            "6:7: no measured signal: name at least one of position, velocity, acceleration, "
            "tachometer, motor_current, V_c, V_m, drive_force, load_position"},
           // What is free.
           {"M: {}", "m: {}", "9:3: unknown quantity 'm'; did you mean 'M'?"},
           {"M: {}", "coulomb_friction: {}",
            "9:3: unknown quantity 'coulomb_friction'; did you mean 'coulomb_friction.F_c'?"},
           {"M: {}", "friction_of_the_arm: {}",
            "9:3: unknown quantity 'friction_of_the_arm'; valid names are parameters of the axis, "
            "EFFECT.PARAMETER, SIGNAL.gain, .bias, .lag, .delay and .drift, and initial.y0 ... "
            "initial.y6"},
           {"M: {}", "K_m: {}",
            "9:3: K_m is not used by this axis, because of its drive or transmission"},
           {"free:\n  M: {}", "free: {}", "8:7: no free quantity: name at least one to fit"},
           {"free:\n  M: {}", "free: [M]",
            "8:7: free must be a map of keys and values, not a list"},
           {"M: {}", "M: {intial: 3 kg}", "9:7: unknown key 'intial'; did you mean 'initial'?"},
           {"M: {}", "M: {initial: 3}", "9:16: initial needs a unit, for example '3 kg'"},
           {"M: {}", "M: {initial: 0 kg}",
            "9:16: initial must lie between 0.001 kg and 1e+05 kg, not 0 kg"},
           {"M: {}", "M: {bounds: [5 kg, 9 kg]}",
            "9:6: the initial value 4 kg of M lies outside its bounds, 5 kg to 9 kg"},
           {"M: {}", "M: {bounds: [9 kg, 5 kg]}",
            "9:15: bounds must be given as [lower, upper], but 9 kg is not less than 5 kg"},
           {"M: {}", "M: {bounds: 9 kg}",
            "9:15: bounds must be a list of two values: [lower, upper]"},
           {"M: {}", "M: {bounds: [1 kg, 5 m]}",
            "9:22: entry 2 of bounds: 'm' cannot be converted to 'kg'; use for example 'kg'"},
           {"M: {}", "M: {scale: logarithmic}",
            "9:14: scale must be one of log, linear, from_zero, not 'logarithmic'"},
           {"M: {}", "B_a: {scale: log, bounds: [0 N s/m, 9 N s/m]}",
            "9:8: B_a on a logarithmic scale needs an initial value and a lower bound above zero"},
           {"M: {}", "M: {per_recording: each}",
            "9:22: per_recording must be true or false, not 'each'"},
           // How to fit.
           {"free:\n", "fit: {threads: 2}\nfree:\n",
            "8:7: unknown key 'threads'; known keys: observer, initial_observer_gain, horizon, "
            "loss, "
            "huber_width, max_iterations, starts, seed, spread, step"},
           {"free:\n", "fit: {observer: loose}\nfree:\n",
            "8:17: observer must be continuation, none, or a fixed gain such as {fixed: 300 1/s}"},
           {"free:\n", "fit: {observer:}\nfree:\n",
            "8:7: observer must be continuation, none, or a fixed gain such as {fixed: 300 1/s}"},
           {"free:\n", "fit: {observer: none, initial_observer_gain: 3 1/s}\nfree:\n",
            "8:46: initial_observer_gain needs observer: continuation"},
           {"free:\n", "fit: {horizon: long}\nfree:\n",
            "8:16: horizon must be whole, auto, or a time with its unit, such as 2 s"},
           {"free:\n", "fit: {horizon: 2 m}\nfree:\n",
            "8:16: horizon: 'm' cannot be converted to 's'; use for example 's'"},
           {"free:\n", "fit: {horizon: 1 s, observer: {fixed: 3 1/s}}\nfree:\n",
            "8:16: with a fixed observer nothing runs free: remove 'horizon', or let it be chosen "
            "with 'horizon: auto'"},
           {"free:\n", "fit: {observer: {fixd: 3 1/s}}\nfree:\n",
            "8:18: unknown key 'fixd'; did you mean 'fixed'?"},
           {"free:\n", "fit: {observer: {fixed: 3}}\nfree:\n",
            "8:25: fixed needs a unit, for example '3 1/s'"},
           {"free:\n", "fit: {loss: hubre}\nfree:\n",
            "8:13: loss must be one of squares, huber, not 'hubre'; did you mean 'huber'?"},
           {"free:\n", "fit: {max_iterations: 0}\nfree:\n",
            "8:23: max_iterations must be a whole number between 1 and 100000, not '0'"},
           {"free:\n", "fit: {step: 1}\nfree:\n", "8:13: step needs a unit, for example '1 s'"},
           {"free:\n", "fit: {spread: 0.5}\nfree:\n",
            "8:15: spread must lie between 1 and 1e+06, not 0.5"},
       }) {
    EXPECT_EQ(errors_with(from, to), "job.yaml:" + std::string(message)) << to;
  }
}

// The signal that holds the simulation to the end is taken to be on time.
TEST_F(JobFileTest, RefusesALateSignalThatHoldsTheSimulation) {
  const std::string fixed = std::string(kJob) + "fit: {observer: {fixed: 300 1/s}}\n";
  const std::string message = "a fixed observer gain assumes that the recorded velocity has no ";
  EXPECT_EQ(errors(replaced(fixed, "M: {}", "velocity.delay: {}")),
            "job.yaml:9:19: " + message +
                "delay: remove velocity.delay and fit T_d, which delays the whole motion, or use "
                "observer: continuation");
  EXPECT_EQ(
      errors(replaced(fixed, "M: {}", "velocity.lag: {}")),
      "job.yaml:9:17: " + message + "lag: remove velocity.lag and use observer: continuation");
  EXPECT_EQ(errors(replaced(fixed, "    signals:", "    set: {velocity.lag: 1 ms}\n    signals:")),
            "job.yaml:7:7: " + message + "lag: remove velocity.lag and use observer: continuation");
  EXPECT_NO_THROW(read(replaced(fixed, "M: {}", "position.delay: {}")));
  EXPECT_NO_THROW(read(replaced(kJob, "M: {}", "velocity.delay: {}")));
}

TEST_F(JobFileTest, MistakesInARecordingNameItsLine) {
  folder_.write("data.csv", "t_ms,u,v\n0,0,1\n1,0,2\n2,0\n3,0,4\n");
  EXPECT_EQ(errors(kJob).substr(0, 27), "job.yaml:3:11: data.csv:4: ");
  std::string rows = "t_ms,u,v\n";
  for (int i = 0; i < 12; ++i) rows += fmt::format("{},0,{}\n", i, i);
  folder_.write("data.csv", rows + "12,0,x\n");
  EXPECT_EQ(errors(kJob),
            "job.yaml:7:26: 'v' in data.csv has 'x' in line 14, which is no number; correct it or "
            "leave the field blank");
  Data data;
  data.t_ms[7] = data.t_ms[5];
  write_data("data.csv", data.columns());
  EXPECT_EQ(errors(kJob).substr(0, 27), "job.yaml:4:11: data.csv:9: ");
  // Instants that differ late.
  for (std::size_t i = 0; i < kRows; ++i) data.t_ms[i] = 1e9 + static_cast<double>(i);
  data.t_ms[7] = data.t_ms[6] - 0.5;
  write_data("data.csv", data.columns());
  EXPECT_EQ(errors(kJob),
            "job.yaml:4:11: data.csv:9: time 1000000.0055 s does not increase from 1000000.006 s: "
            "samples must be in order of time, without repeats");
}

TEST_F(JobFileTest, AllMistakesAreNamedAtOnce) {
  EXPECT_EQ(
      errors(R"(axis: mass.yaml
recordings:
  - file: data.csv
    role: train
    time: {column: time, unit: ms}
    signals:
      command: {column: u, unit: Volt}
      velocity: {column: v, unit: m/s, sigma: 1 mm/s, sing: -1}
  - file: none.csv
    set: {M_a: 3 kg}
    time: {column: t_ms, unit: ms}
free:
  B_a: {initial: -1 N s/m}
  K_t: {}
fit: {loss: cubes}
colour: red
)"),
      "job.yaml:4:11: role must be one of fit, validate, not 'train'\njob.yaml:5:20: no column "
      "'time' in data.csv; did you mean 't_ms'? It has t_ms, u, v, x, f\njob.yaml:8:55: unknown "
      "key 'sing'; did you mean 'sign'?\njob.yaml:9:5: key 'signals' is missing in entry 2 of "
      "recordings\njob.yaml:9:11: none.csv: cannot be opened (No such file or directory); check "
      "the path and the permissions\njob.yaml:10:11: unknown quantity 'M_a'; did you mean "
      "'B_a'?\njob.yaml:13:18: initial must lie between 0 N s/m and 1e+06 N s/m, not -1 N "
      "s/m\njob.yaml:14:3: K_t is not used by this axis, because of its drive or "
      "transmission\njob.yaml:15:13: loss must be one of squares, huber, not 'cubes'; did you mean "
      "'huber'?\njob.yaml:16:1: unknown key 'colour'; known keys: axis, effects, recordings, free, "
      "fit, limits");
}

}  // namespace
}  // namespace axisfit
