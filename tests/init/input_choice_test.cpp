#include "init/input_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/init/made_job.h"

namespace axisfit {
namespace {

using InputChoiceTest = InitJobTest;

// As that which a servo smooths.
TEST_F(InputChoiceTest, AVelocityThatIsLateIsNotUsed) {
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

// A flag, a sensor that nobody connected, and a command that the drive was not in: none of them is
// taken for a signal, nor do they stop anything.
TEST_F(InputChoiceTest, WhatNeverChangesIsNotUsed) {
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

TEST_F(InputChoiceTest, ACommandThatNeverChangesIsOne) {
  Table table = driven();
  for (double& x : table.columns[1].values) x = 2.0;
  folder_.write("a.csv", table);
  make({"a.csv"});
  EXPECT_NE(folder_.read("job.yaml").find("command: {column: command_v"), std::string::npos);
}

// One column has one sign. A spring that nobody recorded drives the second recording backwards.
TEST_F(InputChoiceTest, TheSignOfAColumnIsThatOfAllRecordings) {
  Table forward = driven(1), back = driven(2);
  for (double& x : forward.columns[1].values) x = -x;
  for (double& x : back.columns[1].values) x = -x;
  folder_.write("a.csv", forward);
  folder_.write("b.csv", back);
  const auto sign_guess = [&] {
    for (const std::string& text : make({"a.csv", "b.csv"}).guesses)
      if (text.find("the power that friction takes") != std::string::npos) return text;
    return std::string();
  };
  std::string text = sign_guess();
  EXPECT_NE(text.find("comes out as -"), std::string::npos) << text;
  EXPECT_NE(text.find(": its sign was inverted"), std::string::npos) << text;
  expect_the_driven_mass(fitted(read()), 1.0 / 60.0);
  // One of them says the contrary.
  for (double& x : back.columns[1].values) x = -x;
  folder_.write("b.csv", back);
  text = sign_guess();
  EXPECT_NE(text.find(": is its sign right? It was left as it is"), std::string::npos) << text;
  EXPECT_EQ(folder_.read("job.yaml").find("sign: -1"), std::string::npos);
}

TEST_F(InputChoiceTest, OneInputServesAllRecordings) {
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

TEST_F(InputChoiceTest, AVelocityThatIsAskedForIsACommand) {
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

TEST_F(InputChoiceTest, AVelocityIsLeftOutOfAllRecordingsOrOfNone) {
  for (const char* name : {"a.csv", "b.csv"}) {
    Table table =
        renamed(driven(static_cast<std::uint64_t>(name[0])),
                {{"t_s", 1.0}, {"iq [A]", 1.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
    table.columns.pop_back();
    // Late in the first alone.
    std::vector<double>& v = table.columns[3].values;
    if (name[0] == 'a')
      std::shift_right(v.begin(), v.end(), 8);
    else  // else it would be the same recording
      for (double& t : table.columns.front().values) t += 1e-4;
    folder_.write(name, table);
  }
  make({"a.csv", "b.csv"});
  const std::string text = folder_.read("job.yaml");
  const JobFile file = read();
  for (const Recording& recording : file.job.recordings)
    EXPECT_EQ(recording.measurements.size(), 1u) << text;
  EXPECT_NE(text.find("ms behind the derivative of the position in a"), std::string::npos) << text;
}

TEST_F(InputChoiceTest, AllRecordingsUseTheSameSignals) {
  for (const char* name : {"a.csv", "b.csv"}) {
    Table table =
        renamed(driven(static_cast<std::uint64_t>(name[0])),
                {{"t_s", 1.0}, {"iq [A]", 1.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
    if (name[0] == 'b') {
      table.columns.pop_back();
      for (double& t : table.columns.front().values) t += 1e-4;  // else it would be the same one
    }
    folder_.write(name, table);
  }
  make({"a.csv", "b.csv"});
  EXPECT_NE(folder_.read("job.yaml").find("# acceleration: {column: a_mps2"), std::string::npos);
  const JobFile file = read();
  ASSERT_EQ(file.job.recordings[0].measurements.size(), file.job.recordings[1].measurements.size());
  for (std::size_t i = 0; i < file.job.recordings[0].measurements.size(); ++i)
    EXPECT_EQ(file.job.recordings[0].measurements[i].signal,
              file.job.recordings[1].measurements[i].signal);
}

TEST_F(InputChoiceTest, APairingThatExplainsNothingIsRefused) {
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"iq [A]", 1.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
  std::mt19937 random(4);
  std::normal_distribution<double> noise;
  for (double& current : table.columns[1].values) current = noise(random);
  folder_.write("a.csv", table);
  try {
    make({"a.csv"});
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("iq [A] explains nothing of how x_m moves"),
              std::string::npos)
        << error.what();
  }
  EXPECT_EQ(folder_.names().count("job.yaml"), 0u);
  make({"a.csv"}, {}, {}, {.columns = {read_answer("current=2:A"), read_answer("position=3:m")}});
}

}  // namespace
}  // namespace axisfit
