// Jobs that are made for recordings: the reader takes them, and they end in a fit.
#include "init/init_job.h"

#include <gtest/gtest.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include "fit/estimate/estimate.h"
#include "io/config/job_file.h"
#include "tests/foreign_recordings.h"
#include "tests/init/made_job.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

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
    Table table = driven(static_cast<std::uint64_t>(name[0]));
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
  EXPECT_EQ(read().job.guessed, std::vector{quantity_index("K_f")});
  axis.replace(axis.find(guessed), guessed.size(), "K_f: 113.0973 N/A");
  axis.erase(axis.find("guessed: [K_f]"), axis.find("parameters:") - axis.find("guessed: [K_f]"));
  folder_.write("axis.yaml", axis);
  EXPECT_TRUE(read().job.guessed.empty());
  const FitResult result = estimate(read().job);
  ASSERT_TRUE(result.is_usable()) << result.message;
  EXPECT_NEAR(result.parameters[0].value, 85.687, 0.01 * 85.687);  // bent by what is missing
  EXPECT_NEAR(result.parameters[1].value, 258.96, 0.05 * 258.96);
  // With the observer gain as high as the samples allow, the simulation follows 6 N that the model
  // lacks.
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

// The first may be too slow to show how large a friction may be.
TEST_F(InitJobTest, TheLargestCommandOfAllRecordingsBoundsTheForces) {
  Table slow = driven();
  for (std::size_t c = 1; c < slow.columns.size(); ++c)
    for (double& x : slow.columns[c].values) x *= 0.1;
  folder_.write("slow.csv", slow);
  folder_.write("fast.csv", driven(2));
  make({"slow.csv", "fast.csv"}, {}, 60.0);
  const std::string text = folder_.read("job.yaml");
  EXPECT_NE(text.find("coulomb_friction.F_c: {bounds: [0 N, 240 N]}"), std::string::npos) << text;
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

TEST_F(InitJobTest, NoMessageIsInTheFileAlone) {
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"i_A", 1.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"humidity", 1.0}});
  folder_.write("a.csv", table);
  EXPECT_EQ(std::ranges::count(make({"a.csv"}).guesses, "not used: humidity"), 1);
}

TEST_F(InitJobTest, AllRecordingsHaveTheSameUnits) {
  // In mm, which one of them does not show: it moves by less than ten.
  for (const auto& [name, size] : {std::pair("a.csv", 0.02), {"b.csv", 1.0}}) {
    Table table = renamed(
        driven(), {{"t_s", 1.0}, {"i_A", size}, {"pos", 1e3 * size}, {"x", 1.0}, {"dummy", 1.0}});
    table.columns.resize(3);
    for (double& t : table.columns.front().values) t += size * 1e-4;
    folder_.write(name, table);
  }
  make({"a.csv", "b.csv"});
  const std::string text = folder_.read("job.yaml");
  EXPECT_EQ(text.find("unit: m}"), std::string::npos) << text;
  EXPECT_NE(text.find("{column: pos, unit: mm}"), std::string::npos) << text;
}

TEST_F(InitJobTest, AxesOfOneFileAreAskedFor) {
  Table table = renamed(driven(), {{"t_s", 1.0},
                                   {"left_current_A", 1.0},
                                   {"left_pos_m", 1.0},
                                   {"v_mps", 1.0},
                                   {"a_mps2", 1.0}});
  const Table other = driven(2);
  table.columns.resize(3);
  table.columns.push_back({"right_current_A", other.columns[1].values});
  table.columns.push_back({"right_pos_m", other.columns[2].values});
  folder_.write("a.csv", table);
  try {
    make({"a.csv"});
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("the columns are of several axes: left (left_current_A, "
                        "left_pos_m); right (right_current_A, right_pos_m). "
                        "Say which by --motor"),
              std::string::npos)
        << error.what();
  }
  make({"a.csv"}, {}, 60.0, {.motor = "right"});
  EXPECT_NE(folder_.read("job.yaml").find("position: {column: right_pos_m, unit: m}"),
            std::string::npos);
  EXPECT_NE(folder_.read("job.yaml").find("command: {column: right_current_A, unit: A"),
            std::string::npos);
}

// Made by a program of its own: M = 0.5 kg, B = 0.4 N s/m.
TEST_F(InitJobTest, AReferenceIsNotFitted) {
  make({AXISFIT_TESTDATA "/contact/q-and-q-des.csv"});
  const auto found = fitted(read());
  EXPECT_NEAR(found.at("J"), 0.5, 0.02);  // a torque without a unit turns a joint
  EXPECT_NEAR(found.at("B_a"), 0.4, 0.04);
}

TEST_F(InitJobTest, TheEmpsAxisIsFoundFromItsFilesAlone) {
  const ForeignRecordings data =
      foreign_recordings("emps", {"DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"});
  if (!data.missing.empty()) GTEST_SKIP() << data.missing;
  make({(data.folder / "DATA_EMPS.mat").string(), (data.folder / "DATA_EMPS_PULSES.mat").string()});
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
  const ForeignRecordings data = foreign_recordings("bam", {"sin_sin_8.csv"});
  if (!data.missing.empty()) GTEST_SKIP() << data.missing;
  constexpr double kGain = 0.38670 / 4.0171 * 7.3 / 885.0;  // N m per count, published (model m1)
  make({(data.folder / "sin_sin_8.csv").string()}, {}, kGain,
       {.columns = {read_answer("position=position:rad")}});
  const std::string job = folder_.read("job.yaml");
  EXPECT_NE(job.find("command: {column: load, unit: V, signed_bits: 16}"), std::string::npos)
      << job;
  EXPECT_NE(job.find("velocity: {column: speed, unit: rad/s}"), std::string::npos) << job;
  Model<double> start = read().job.model;
  EXPECT_EQ(start.structure.joint, Joint::revolute);
  // m l^2 of the pendulum and the published armature; its weight at its lever.
  EXPECT_NEAR(start.axis.M, 0.0049 + 0.0018142, 0.0007);
  EXPECT_NEAR(*members(start)[quantity_index("pendulum_gravity.G_s")], 0.49 * 9.81 * 0.1, 0.05);
}

// A motor that turns slowly in closed loop over its cogging. Over a long time its speed never
// changes, so that the current is that of friction; its inertia shows within a period of the
// cogging. By least squares with the cogging of its two orders, 2.4e-4 A s^2/rad.
TEST_F(InitJobTest, AMassThatOnlyCoggingMovesIsSeen) {
  const ForeignRecordings data = foreign_recordings("laas", {"speed_test1.txt"});
  if (!data.missing.empty()) GTEST_SKIP() << data.missing;
  make({(data.folder / "speed_test1.txt").string()}, {}, {},
       {.columns = {read_answer("position=Position:rad"), read_answer("velocity=Velocity:rad/s")}});
  EXPECT_NEAR(read().job.model.axis.M, 2.4e-4, 0.6e-4);
}

}  // namespace
}  // namespace axisfit
