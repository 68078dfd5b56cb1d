// Jobs that are made for recordings: the reader takes them, and they end in a fit.
#include "init/init_job.h"

#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "fit/estimate/estimate.h"
#include "init/starter_axis.h"
#include "io/config/axis_file.h"
#include "io/config/job_file.h"
#include "tests/apps/files.h"
#include "tests/apps/fit_job.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

class InitJobTest : public ::testing::Test {
 protected:
  /// Makes a job in the folder.
  InitialJob make(std::vector<std::string> recordings, const std::string& axis = {},
                  std::optional<double> gain = {}, const std::vector<ColumnAnswer>& answers = {}) {
    for (std::string& r : recordings)
      if (!fs::path(r).is_absolute()) r = folder_.path(r);
    InitialJob made = initial_job(recordings, axis, folder_.path(), gain, answers);
    for (const auto& [name, contents] : made.files) folder_.write(name, contents);
    return made;
  }

  JobFile read() { return read_job_file(folder_.path("job.yaml")); }

  std::map<std::string, double> fitted(const JobFile& file) {
    const FitResult result = estimate(file.job);
    EXPECT_TRUE(result.usable) << result.message;
    std::map<std::string, double> values;
    for (const ParameterResult& p : result.parameters) {
      EXPECT_TRUE(p.uncertainty.determined) << p.name;
      values[p.name] = p.value;
    }
    return values;
  }

  /// A driven mass: M = 12 kg, B_a = 40 N s/m, F_c = 15 N and F_0 = 4 N at K_f = 60 N/V.
  Table driven(std::uint64_t seed = 1) {
    const std::string axis = folder_.write(
        "true.yaml",
        "drive: force_source\ntransmission: rigid\n"
        "parameters: {K_f: 60 N/V, M: 12 kg, B_a: 40 N s/m}\n"
        "effects: {coulomb_friction: {F_c: 15 N}, constant_force: {F_0: 4 N}}\n"
        "instruments: {velocity: {noise: 1 mm/s}, acceleration: {noise: 0.05 m/s^2}}\n"
        "controller: {counts_per_revolution: 3141592}\n");
    return record_levels(axis, {{2.0, -2.0, 1.0, -1.5, 0.5, -0.8}, 0.3}, 1.8,
                         {Signal::position, Signal::velocity, Signal::acceleration}, 500.0, seed);
  }

  /// Its columns time, command, position, velocity and acceleration, renamed and scaled.
  Table renamed(Table table, const std::vector<std::pair<std::string, double>>& columns) {
    EXPECT_EQ(table.columns.size(), columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c) {
      table.columns[c].name = columns[c].first;
      for (double& x : table.columns[c].values) x *= columns[c].second;
    }
    return table;
  }

  static void expect_the_driven_mass(const std::map<std::string, double>& found, double scale) {
    ASSERT_EQ(found.size(), 4u);
    EXPECT_NEAR(found.at("M"), 12.0 * scale, 0.3 * scale);
    EXPECT_NEAR(found.at("B_a"), 40.0 * scale, 2.0 * scale);
    EXPECT_NEAR(found.at("coulomb_friction.F_c"), 15.0 * scale, 1.0 * scale);
    EXPECT_NEAR(found.at("constant_force.F_0"), 4.0 * scale, 0.5 * scale);
  }

  TempFolder folder_;
};

TEST_F(InitJobTest, ThePapersAxisIsRecognised) {
  make({AXISFIT_TESTDATA "/clean-fit.csv", AXISFIT_TESTDATA "/clean-validate.csv"});
  JobFile file = read();
  ASSERT_EQ(file.job.recordings.size(), 2u);
  EXPECT_EQ(file.job.recordings[0].role, Role::fit);
  EXPECT_EQ(file.job.recordings[1].role, Role::validate);
  EXPECT_EQ(file.job.recordings[0].measurements.size(), 5u);
  EXPECT_EQ(file.job.model.structure.drive, Drive::velocity_loop);
  EXPECT_EQ(file.job.options.starts, 8);  // the gear makes wrong minima
  file.job.options.starts = 1;
  file.job.options.continuation.reset();  // quicker; it starts at the truth
  const auto found = fitted(file);
  EXPECT_NEAR(found.at("V_L"), 2.7, 0.01);
  EXPECT_NEAR(found.at("k_g"), 5e6, 5e4);
  EXPECT_NEAR(found.at("B_a"), 200.0, 1.0);
}

TEST_F(InitJobTest, ATemperatureAndASupplyBecomeChannels) {
  for (const char* name : {"a.csv", "b.csv"}) {
    Table table = driven(name[0]);
    const std::size_t rows = table.columns[0].values.size();
    Column warm{"T_oil [degC]", {}}, bus{"bus voltage [V]", {}}, fixed{"temperature", {}},
        other{"humidity", {}};
    for (std::size_t i = 0; i < rows; ++i) {
      warm.values.push_back(20.0 + 0.01 * double(i));
      bus.values.push_back(48.0 - 0.1 * double(i % 7));
      fixed.values.push_back(25.0);
      other.values.push_back(double(i % 3));
    }
    for (const Column& column : {warm, bus, fixed, other}) table.columns.push_back(column);
    folder_.write(name, table);
  }
  make({"a.csv", "b.csv"}, {}, 60.0);
  const JobFile file = read();
  ASSERT_NE(file.job.model.structure.channels, nullptr);
  EXPECT_EQ(file.job.model.structure.channels->at(0).name, "temperature");
  EXPECT_EQ(file.job.model.structure.channels->at(1).name, "supply");
  EXPECT_EQ(file.job.recordings[1].channels.size(), 2u);
  const std::string text = folder_.read("job.yaml");
  EXPECT_NE(text.find("Not used: temperature, humidity"), std::string::npos) << text;
  expect_the_driven_mass(fitted(file), 1.0);
}

TEST_F(InitJobTest, WhatTheRecordingsLeaveOpenIsNotFree) {
  make({AXISFIT_TESTDATA "/clean-slow.csv"}, AXISFIT_CONFIGS "/axes/x.yaml");
  EXPECT_EQ(folder_.names(), (std::set<std::string>{"job.yaml"}));
  const std::string text = folder_.read("job.yaml");
  EXPECT_NE(text.find("\n  # V_L: {}   not free: no recorded signal depends on it"),
            std::string::npos)
      << text;
  for (const FreeParameter& p : read().job.free) EXPECT_NE(quantity_list()[p.quantity].name, "V_L");
}

TEST_F(InitJobTest, UnitsAndSignsComeFromNamesAndDerivatives) {
  // Milliseconds, millimetres, a velocity with the wrong sign and no unit, g, and milliamperes.
  folder_.write("a.csv", renamed(driven(), {{"Time [ms]", 1e3},
                                            {"Motorstrom [mA]", 1e3},
                                            {"Istposition [mm]", 1e3},
                                            {"Geschwindigkeit", -1e3},
                                            {"a_g", 1.0 / 9.80665}}));
  make({"a.csv"});
  const std::string text = folder_.read("job.yaml");
  // The position tells the same more precisely.
  EXPECT_NE(text.find("# velocity: {column: Geschwindigkeit, unit: mm/s, sign: -1}"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("acceleration: {column: a_g, unit: m/s^2, factor: 9.80665}"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("# GUESSED: "), std::string::npos);
  expect_the_driven_mass(fitted(read()), 1.0 / 60.0);
}

TEST_F(InitJobTest, AnglesMakeARevoluteJoint) {
  const std::string axis = folder_.write(
      "true.yaml",
      "joint: revolute\ndrive: torque_source\ntransmission: rigid\n"
      "parameters: {K_f: 0.2 N m/V, J: 24 g m^2, B_a: 0.04 N m s/rad}\n"
      "effects: {coulomb_friction: {T_c: 0.05 N m}, constant_torque: {T_0: 0.03 N m}}\n"
      "instruments: {position: {noise: 0.01 deg}, velocity: {noise: 0.2 deg/s}}\n");
  constexpr double kPi = 3.14159265358979;
  const Table table = renamed(
      record_levels(axis, {{2.0, -2.0, 1.0, -1.5, 0.5, -0.8}, 0.3}, 1.8,
                    {Signal::position, Signal::velocity}, 500.0),
      {{"t [s]", 1.0}, {"iq [A]", 1.0}, {"angle [deg]", 180.0 / kPi}, {"speed [rpm]", 30.0 / kPi}});
  folder_.write("a.csv", table);
  make({"a.csv"});
  const std::string made = folder_.read("axis.yaml"), job = folder_.read("job.yaml");
  for (const char* expected : {"joint: revolute\n", "drive: motor_current ",
                               "\n  J: ", "{T_c: ", "constant_torque: {T_0: ", "K_f: 1 N m/A"})
    EXPECT_NE(made.find(expected), std::string::npos) << expected << "\n" << made;
  for (const char* expected : {"position: {column: \"angle [deg]\", unit: deg}",
                               "velocity: {column: \"speed [rpm]\", unit: rpm}"})
    EXPECT_NE(job.find(expected), std::string::npos) << expected << "\n" << job;
  EXPECT_EQ(job.find("1 rad"), std::string::npos) << job;
  const auto found = fitted(read());
  EXPECT_NEAR(found.at("J"), 0.12, 0.003);
  EXPECT_NEAR(found.at("B_a"), 0.2, 0.01);
  EXPECT_NEAR(found.at("coulomb_friction.T_c"), 0.25, 0.01);
  EXPECT_NEAR(found.at("constant_torque.T_0"), 0.15, 0.01);
}

// Each machine of the list is an axis file that is valid, and the job begins with it.
TEST_F(InitJobTest, AMachineIsTakenByItsName) {
  for (const MachineAxis& machine : machine_axes()) {
    Diagnostics diagnostics;
    const auto rig = read_axis(
        *ConfigNode::parse(std::string(machine.text), "axis.yaml", diagnostics), diagnostics);
    EXPECT_TRUE(rig && diagnostics.empty()) << machine.name;
  }
  folder_.write(
      "a.csv",
      renamed(driven(),
              {{"t_s", 1.0}, {"iq [A]", 1.0}, {"pos [mm]", 1e3}, {"v_mps", 1.0}, {"a_mps2", 1.0}}));
  const InitialJob made =
      initial_job({folder_.path("a.csv")}, "linear-motor", folder_.path(), {}, {}, true);
  for (const auto& [name, contents] : made.files) folder_.write(name, contents);
  EXPECT_NE(folder_.read("axis.yaml").find("name: slide with a linear motor"), std::string::npos);
  const JobFile file = read();
  EXPECT_EQ(file.job.model.structure.drive, Drive::motor_current);
  expect_the_driven_mass(fitted(file), 1.0);  // both have 60 N/A
  EXPECT_THROW(initial_job({folder_.path("a.csv")}, "loom", folder_.path(), {}, {}, true),
               std::runtime_error);
}

TEST_F(InitJobTest, ARowOfUnitsCountsAsTheNames) {
  folder_.write(
      "plain.csv",
      renamed(driven(), {{"t", 1e3}, {"iq", 1e3}, {"pos", 1e6}, {"vel", 1e3}, {"acc", 1.0}}));
  std::string text = folder_.read("plain.csv");
  text.insert(text.find('\n') + 1, "ms,mA,[\xC2\xB5m],,g\n");
  folder_.write("a.csv", text);
  make({"a.csv"});
  const std::string job = folder_.read("job.yaml");
  for (const char* line :
       {"time: {column: t, unit: ms}", "command: {column: iq, unit: mA}",
        "position: {column: pos, unit: um}", "velocity: {column: vel, unit: mm/s}"})
    EXPECT_NE(job.find(line), std::string::npos) << line << '\n' << job;
  // What the row says is checked as what a name says.
  EXPECT_NE(job.find("the header says g, but it is"), std::string::npos) << job;
  expect_the_driven_mass(fitted(read()), 1.0 / 60.0);
}

TEST_F(InitJobTest, TheUsersGainIsAllThatABentScrewNeeds) {
  make({AXISFIT_TESTDATA "/screw/bent-sweep.csv", AXISFIT_TESTDATA "/screw/bent-move.csv"});
  std::string axis = folder_.read("axis.yaml");
  const std::string guessed = "K_f: 1 N/A";
  ASSERT_NE(axis.find(guessed), std::string::npos) << axis;
  EXPECT_EQ(read().job.guessed, std::vector{find_quantity("K_f")->index});
  axis.replace(axis.find(guessed), guessed.size(), "K_f: 113.0973 N/A");
  axis.erase(axis.find("guessed: [K_f]"), axis.find("parameters:") - axis.find("guessed: [K_f]"));
  folder_.write("axis.yaml", axis);
  EXPECT_TRUE(read().job.guessed.empty());
  const FitResult result = estimate(read().job);
  ASSERT_TRUE(result.usable) << result.message;
  EXPECT_NEAR(result.parameters[0].value, 85.687, 0.01 * 85.687);  // bent by what is missing
  EXPECT_NEAR(result.parameters[1].value, 258.96, 0.05 * 258.96);
  // Held as firmly as the samples allow, the simulation follows 6 N that the model lacks.
  EXPECT_GT(result.reduced_chi_square, 10.0);
}

TEST_F(InitJobTest, NothingButShortNamesIsEnough) {
  folder_.write(
      "a.csv",
      renamed(driven(), {{"t", 1e3}, {"iq", -1.0}, {"pos", 1e3}, {"vel", 1e3}, {"dummy", 1}}));
  Table other =
      renamed(driven(2), {{"t", 1e3}, {"iq", -1.0}, {"pos", 1e3}, {"vel", 1e3}, {"dummy", 1}});
  for (double& x : other.columns[2].values) x += 100.0;  // it began elsewhere
  folder_.write("b.csv", other);
  const InitialJob made = make({"a.csv", "b.csv"});
  const std::string text = folder_.read("job.yaml");
  EXPECT_NE(text.find("\n    # Not used: dummy\n"), std::string::npos) << text;
  EXPECT_NE(text.find("command: {column: iq, unit: A, sign: -1}"), std::string::npos) << text;
  EXPECT_NE(text.find("times the derivative of the position: taken as mm/s"), std::string::npos);
  EXPECT_GE(made.guesses.size(), 3u);
  const JobFile file = read();
  EXPECT_EQ(file.job.recordings[1].role, Role::validate);
  expect_the_driven_mass(fitted(file), 1.0 / 60.0);
}

TEST_F(InitJobTest, ALargeCurrentLeavesNoRoomBeyondTheBounds) {
  folder_.write(
      "a.csv",
      renamed(driven(),
              {{"t_s", 1.0}, {"current_a", 20.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}}));
  make({"a.csv"});
  const std::string bounds = "coulomb_friction.F_c: {bounds: [0 N, 100000 N]}";
  EXPECT_NE(folder_.read("job.yaml").find(bounds), std::string::npos) << folder_.read("job.yaml");
  expect_the_driven_mass(fitted(read()), 20.0 / 60.0);
}

TEST_F(InitJobTest, AForceNeedsNoGain) {
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"force_kN", 0.06}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
  folder_.write("a.csv", table);
  const InitialJob made = make({"a.csv"});
  EXPECT_TRUE(made.guesses.empty()) << made.guesses.front();
  expect_the_driven_mass(fitted(read()), 1.0);
}

// Recordings of a simulation that is not ours: 4.2 kg, 9 N s/m, 2.1 N. As a staircase the force
// would make 9.4 N s/m of it.
TEST_F(InitJobTest, WhatWasMeasuredIsNoStaircase) {
  for (const auto& [file, gain] :
       {std::pair("labview-like.csv", std::optional<double>()), {"headerless.txt", 6.5}}) {
    SCOPED_TRACE(file);
    make({std::string(AXISFIT_TESTDATA "/drives/") + file}, {}, gain);
    const JobFile job = read();
    EXPECT_EQ(job.job.recordings.front().command.hold, Hold::linear);
    const auto found = fitted(job);
    EXPECT_NEAR(found.at("M"), 4.2, 0.002);
    EXPECT_NEAR(found.at("B_a"), 9.0, 0.1);
    EXPECT_NEAR(found.at("coulomb_friction.F_c"), 2.1, 0.01);
  }
}

// As that which a servo smooths.
TEST_F(InitJobTest, AVelocityThatIsLateIsNotUsed) {
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"iq [A]", 1.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
  table.columns.pop_back();
  for (const int late : {0, 1, 8}) {
    std::vector<double>& v = table.columns[3].values;
    std::shift_right(v.begin(), v.end(), late);
    std::fill_n(v.begin(), late, v[static_cast<std::size_t>(late)]);
    make({folder_.write("a.csv", table)});
    const bool said =
        folder_.read("job.yaml").find("ms behind the derivative") != std::string::npos;
    EXPECT_EQ(said, late == 8) << late;
  }
}

TEST_F(InitJobTest, NamesCannotBreakOutOfTheFile) {
  const std::string name = "pos: {x}, # \"q\" - 'a' [mm]";
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"i_A", 1.0}, {name, 1e3}, {"- &x *y", 1.0}, {"!!null ~", 1.0}});
  folder_.write("true: # a.csv", table);
  make({"true: # a.csv"});
  const JobFile file = read();
  EXPECT_EQ(file.job.recordings[0].file, "true: # a.csv");
  EXPECT_EQ(file.job.recordings[0].measurements.size(), 1u);
}

TEST_F(InitJobTest, NamesOfAllKindsAreTaken) {
  // A micro sign as Windows has it; a line that Unicode breaks, and a bell, in a name.
  Table table = renamed(driven(), {{"t_s", 1.0},
                                   {"i_A", 1.0},
                                   {"x_m", 1.0},
                                   {"v [\xB5m/s]", 1e6},
                                   {"a\u2028free: \xB0\a", 1.0}});
  folder_.write("a.csv", table);
  make({"a.csv"});
  EXPECT_EQ(read().job.recordings[0].measurements.size(), 1u);
  EXPECT_NE(folder_.read("job.yaml").find("# velocity: {column: \"v [µm/s]\", unit: um/s}"),
            std::string::npos);
  EXPECT_NE(folder_.read("job.yaml").find("# Not used: aâ€¨free: °? (column 5)\n"),
            std::string::npos)
      << folder_.read("job.yaml");
}

// A flag, a sensor that nobody connected, and a command that the drive was not in: none of them is
// taken for a signal, nor do they stop anything.
TEST_F(InitJobTest, WhatNeverChangesIsNotUsed) {
  Table table = renamed(
      driven(),
      {{"t_s", 1.0}, {"i_A", 1.0}, {"x_m", 1.0}, {"velocity_mps", 0.0}, {"torque_enable", 0.0}});
  for (double& x : table.columns.back().values) x = 1.0;
  folder_.write("a.csv", table);
  const InitialJob made = make({"a.csv"});
  EXPECT_EQ(std::ranges::count(made.guesses, "velocity_mps: not used, for it never changes"), 1);
  const JobFile file = read();
  ASSERT_EQ(file.job.recordings[0].measurements.size(), 1u);
  EXPECT_EQ(file.job.recordings[0].measurements[0].signal, Signal::position);
  EXPECT_EQ(fitted(file).size(), 4u);
  EXPECT_NE(folder_.read("job.yaml").find("command: {column: i_A"), std::string::npos);
}

TEST_F(InitJobTest, ACommandThatNeverChangesIsOne) {
  Table table = driven();
  for (double& x : table.columns[1].values) x = 2.0;
  folder_.write("a.csv", table);
  make({"a.csv"});
  EXPECT_NE(folder_.read("job.yaml").find("command: {column: command_v"), std::string::npos);
}

TEST_F(InitJobTest, ACopyIsRefused) {
  const Table table = driven();
  folder_.write("a.csv", table);
  folder_.write("b.csv", table);
  for (const char* second : {"a.csv", "b.csv"}) {
    try {
      make({"a.csv", second});
      ADD_FAILURE() << second;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("a recording counts once"), std::string::npos)
          << error.what();
    }
  }
}

TEST_F(InitJobTest, AKnownGainIsAllThatACurrentNeeds) {
  Table table = driven();
  table.columns[1].name = "i_A";
  folder_.write("a.csv", table);
  const InitialJob made = make({"a.csv"}, {}, 60.0);
  EXPECT_TRUE(made.guesses.empty()) << made.guesses.front();
  const JobFile file = read();
  EXPECT_EQ(file.job.model.axis.K_f, 60.0);
  EXPECT_TRUE(file.job.guessed.empty());
  EXPECT_NEAR(file.job.model.axis.M, 12.0, 2.0);
  expect_the_driven_mass(fitted(file), 1.0);
  table.columns[1].name = "force_N";
  folder_.write("a.csv", table);
  EXPECT_THROW(make({"a.csv"}, {}, 60.0), std::runtime_error);
}

// Without the rating, a torque in per cent is no force: K_f, the rated force, is a guess.
TEST_F(InitJobTest, APartOfARatingNeedsTheGain) {
  folder_.write("a.csv", renamed(driven(), {{"t_s", 1.0},
                                            {"TorqueActual [%]", 1.0},
                                            {"Lage-Ist [mm]", 1e3},
                                            {"v_mps", 1.0},
                                            {"a_mps2", 1.0}}));
  const InitialJob made = make({"a.csv"});
  ASSERT_EQ(made.guesses.size(), 1u);
  EXPECT_TRUE(made.guesses[0].starts_with("the drive gain, K_f in axis.yaml")) << made.guesses[0];
  EXPECT_NE(folder_.read("job.yaml").find("command: {column: \"TorqueActual [%]\", unit: \"%\"}"),
            std::string::npos)
      << folder_.read("job.yaml");
  const JobFile file = read();
  EXPECT_EQ(file.job.model.structure.drive, Drive::rated_force);
  EXPECT_EQ(file.job.guessed, std::vector{find_quantity("K_f")->index});
  expect_the_driven_mass(fitted(file), 1.0 / 60.0);
}

// One column has one sign. A spring that nobody recorded drives the second recording backwards.
TEST_F(InitJobTest, TheSignOfAColumnIsThatOfAllRecordings) {
  Table forward = driven(1), back = driven(2);
  for (double& x : forward.columns[1].values) x = -x;
  for (double& x : back.columns[1].values) x = -x;
  folder_.write("a.csv", forward);
  folder_.write("b.csv", back);
  const auto sign_guess = [&] {
    for (const std::string& text : make({"a.csv", "b.csv"}).guesses)
      if (text.find("opposite direction") != std::string::npos) return text;
    return std::string();
  };
  std::string text = sign_guess();
  EXPECT_NE(text.find(" in a, -"), std::string::npos) << text;
  EXPECT_NE(text.find(": its sign was inverted"), std::string::npos) << text;
  expect_the_driven_mass(fitted(read()), 1.0 / 60.0);
  // One of them says the contrary.
  for (double& x : back.columns[1].values) x = -x;
  folder_.write("b.csv", back);
  text = sign_guess();
  EXPECT_NE(text.find(": is its sign right? It was left as it is"), std::string::npos) << text;
  EXPECT_EQ(folder_.read("job.yaml").find("sign: -1"), std::string::npos);
}

// The noise of a signal that stays where it is shows while it moves.
TEST_F(InitJobTest, AnAxisAtRestForMostOfTheTimeIsFitted) {
  Table table = driven();
  const std::size_t n = table.columns[0].values.size();
  for (Column& column : table.columns) {
    const bool time = column.name == "time_s";
    const double last = column.name == "position_m" || time ? column.values.back() : 0.0;
    for (std::size_t i = 1; i <= 2 * n; ++i)
      column.values.push_back(time ? last + static_cast<double>(i) / 500.0 : last);
  }
  folder_.write("a.csv", table);
  make({"a.csv"});
  const JobFile file = read();
  EXPECT_EQ(file.job.recordings[0].measurements.size(), 2u);
}

TEST_F(InitJobTest, OneInputServesAllRecordings) {
  // What a current moves says nothing of what a force does: the force is not in both.
  Table both = renamed(
      driven(), {{"t_s", 1.0}, {"force_N", 60.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
  both.columns.push_back({"i_A", both.columns[1].values});
  for (double& i : both.columns.back().values) i /= 60.0;
  folder_.write("a.csv", both);
  both.columns.erase(both.columns.begin() + 1);
  for (double& t : both.columns.front().values) t += 1e-4;  // else it would be the same recording
  folder_.write("b.csv", both);
  make({"a.csv", "b.csv"});
  const JobFile file = read();
  ASSERT_EQ(file.job.recordings.size(), 2u);
  expect_the_driven_mass(fitted(file), 1.0 / 60.0);
}

TEST_F(InitJobTest, MatlabVariablesAreColumnsToo) {
  mat_t* mat = Mat_CreateVer(folder_.path("run.mat").c_str(), nullptr, MAT_FT_MAT5);
  ASSERT_NE(mat, nullptr);
  const Table table =
      renamed(driven(), {{"t", 1.0}, {"u", 1.0}, {"qm", 1.0}, {"line\nbreak", 1.0}, {"acc", 1.0}});
  for (const Column& c : table.columns) {
    std::vector<double> values = c.values;
    std::array<std::size_t, 2> size{values.size(), 1};
    matvar_t* variable =
        Mat_VarCreate(c.name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0);
    EXPECT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
  }
  // Of another length, and not a column at all.
  std::array<double, 3> constants{1.0, 2.0, 3.0};
  std::array<std::size_t, 2> size{3, 1};
  matvar_t* gains =
      Mat_VarCreate("velocity", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), constants.data(), 0);
  Mat_VarWrite(mat, gains, MAT_COMPRESSION_NONE);
  Mat_VarFree(gains);
  Mat_Close(mat);
  make({"run.mat"});
  EXPECT_NE(folder_.read("job.yaml").find("# Not used: line?break (column 4), velocity"),
            std::string::npos)
      << folder_.read("job.yaml");
  expect_the_driven_mass(fitted(read()), 1.0 / 60.0);
}

TEST_F(InitJobTest, RecordingsOfOneNameGetDifferentOnes) {
  fs::create_directories(folder_.path("one"));
  fs::create_directories(folder_.path("two"));
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"i_A", 1.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
  folder_.write("one/run.csv", table);
  for (double& t : table.columns.front().values) t += 1e-4;  // else it would be the same recording
  folder_.write("two/run.csv", table);
  make({"one/run.csv", "two/run.csv"});
  const JobFile file = read();
  EXPECT_EQ(file.job.recordings[0].file, "one/run.csv");
  EXPECT_NE(file.job.recordings[0].name, file.job.recordings[1].name);
}

TEST_F(InitJobTest, AVelocityThatIsAskedForIsACommand) {
  Table table = record_levels(AXISFIT_CONFIGS "/axes/x.yaml", {{6.0, -4.0, 2.0}, 0.2}, 0.6,
                              {Signal::velocity}, 500.0);
  table.columns[1].name = "velocity setpoint [mm/s]";
  for (double& x : table.columns[1].values) x *= 100.0;  // 10 V for 1 m/s
  folder_.write("a.csv", table);
  const InitialJob made = make({"a.csv"});
  EXPECT_EQ(made.guesses.size(), 2u);
  const Schedule command = read().job.recordings[0].command;
  EXPECT_NEAR(command.values.front(), 6.0, 1e-9);
}

TEST_F(InitJobTest, APositionThatIsAskedForNeedsTheController) {
  Table table = record_levels(AXISFIT_CONFIGS "/axes/x.yaml", {{6.0, -4.0, 2.0}, 0.2}, 0.6,
                              {Signal::position}, 500.0);
  table.columns[1].name = "reference_position_m";
  folder_.write("a.csv", table);
  EXPECT_THROW(make({"a.csv"}), std::runtime_error);
  make({"a.csv"}, AXISFIT_CONFIGS "/axes/x.yaml");
  EXPECT_NE(folder_.read("job.yaml").find("position_reference: {column: reference_position_m"),
            std::string::npos);
}

TEST_F(InitJobTest, SaysWhatIsMissing) {
  const auto message = [&](const std::string& header) {
    std::string contents = header + "\n";
    for (int i = 0; i < 40; ++i)
      contents += std::to_string(i * 1e-3) + "," + std::to_string(std::sin(i)) + "\n";
    folder_.write("a.csv", contents);
    try {
      make({"a.csv"});
    } catch (const std::runtime_error& error) {
      return folder_.without_path(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(
      message("time_s,pos_mm"),
      "a.csv: no column shows what drove the axis; the columns are time_s, pos_mm. If one of them "
      "does, say so by --column current=COLUMN:A, force=COLUMN:N or command=COLUMN:V; otherwise "
      "record that signal.");
  EXPECT_EQ(message("time_s,iq"),
            "a.csv: no column shows how the axis moved; the columns are time_s, iq. If one of them "
            "does, say so by --column position=COLUMN:mm or velocity=COLUMN:m/s; otherwise record "
            "that signal.");
  EXPECT_EQ(
      message("foo,bar"),
      "a.csv: no column shows what drove the axis; the columns are foo, bar (not recognised). "
      "If one of them does, say so by --column current=COLUMN:A, force=COLUMN:N or "
      "command=COLUMN:V; otherwise record that signal.");
  EXPECT_TRUE(folder_.names().count("job.yaml") == 0);
}

TEST_F(InitJobTest, TheEmpsAxisIsFoundFromItsFilesAlone) {
  const char* given = std::getenv("AXISFIT_EMPS");
  const fs::path data =
      given != nullptr && *given != '\0' ? given : AXISFIT_CONFIGS "/../../shared/data/emps";
  if (!fs::exists(data / "DATA_EMPS.mat") || !fs::exists(data / "DATA_EMPS_PULSES.mat"))
    GTEST_SKIP() << "There are no EMPS recordings in " << data
                 << ". To run this test, name their folder in the environment variable "
                    "AXISFIT_EMPS.";
  make({(data / "DATA_EMPS.mat").string(), (data / "DATA_EMPS_PULSES.mat").string()});
  const auto found = fitted(read());
  constexpr double kGain = 35.15065188248547;  // N/V, published; the job takes 1 N/V
  EXPECT_NEAR(kGain * found.at("M"), 95.1089, 0.03 * 95.1089);
  EXPECT_NEAR(kGain * found.at("B_a"), 203.5034, 0.03 * 203.5034);
  EXPECT_NEAR(kGain * found.at("coulomb_friction.F_c"), 20.3935, 0.03 * 20.3935);
  EXPECT_NEAR(kGain * found.at("constant_force.F_0"), 3.1648, 0.10 * 3.1648);
}

// A hobby servo: whole numbers without a sign for its duty, a supply beside them, no units, and a
// weight that no column tells of.
TEST_F(InitJobTest, AServoWithAPendulumIsReadFromItsFileAlone) {
  const char* given = std::getenv("AXISFIT_BAM");
  const fs::path data =
      given != nullptr && *given != '\0' ? given : AXISFIT_CONFIGS "/../../shared/data/bam";
  if (!fs::exists(data / "sin_sin_8.csv"))
    GTEST_SKIP() << "There are no recordings of the servo in " << data
                 << ". To run this test, name their folder in the environment variable "
                    "AXISFIT_BAM.";
  constexpr double kGain = 0.38670 / 4.0171 * 7.3 / 885.0;  // N m per count, published (model m1)
  make({(data / "sin_sin_8.csv").string()}, {}, kGain, {read_answer("position=position:rad")});
  const std::string job = folder_.read("job.yaml");
  EXPECT_NE(job.find("command: {column: load, unit: V, signed_bits: 16}"), std::string::npos)
      << job;
  EXPECT_NE(job.find("velocity: {column: speed, unit: rad/s}"), std::string::npos) << job;
  Model<double> start = read().job.model;
  EXPECT_EQ(start.structure.joint, Joint::revolute);
  // m l^2 of the pendulum and the published armature; its weight at its lever.
  EXPECT_NEAR(start.axis.M, 0.0049 + 0.0018142, 0.0007);
  EXPECT_NEAR(*members(start)[find_quantity("pendulum_gravity.G_s")->index], 0.49 * 9.81 * 0.1,
              0.05);
}

}  // namespace
}  // namespace axisfit
