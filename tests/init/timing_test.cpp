#include "init/timing.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/base/noise.h"
#include "tests/init/made_job.h"

namespace axisfit {
namespace {

class TimingTest : public InitJobTest {
 protected:
  const FreeParameter* delay(const Job& job) {
    const auto found = std::ranges::find(job.free, quantity_index("T_d"), &FreeParameter::quantity);
    return found == job.free.end() ? nullptr : &*found;
  }
};

// The position is logged three samples after what drives it.
TEST_F(TimingTest, ALateLogFreesTheDelay) {
  Table table = driven();
  EXPECT_EQ((folder_.write("a.csv", table), make({"a.csv"}), delay(read().job)), nullptr);
  for (std::size_t c = 2; c < table.columns.size(); ++c) {
    std::vector<double>& values = table.columns[c].values;
    values.insert(values.begin(), 3, values.front());
    values.resize(values.size() - 3);
  }
  folder_.write("late.csv", table);
  const InitialJob made = make({"late.csv"});
  const Job job = read().job;
  ASSERT_NE(delay(job), nullptr);
  EXPECT_NEAR(delay(job)->initial, 0.006, 0.0005);
  EXPECT_TRUE(std::ranges::any_of(made.guesses, [](const std::string& text) {
    return text.starts_with("T_d is free: the motion follows");
  }));
}

// The current of this machine holds for a sample, which a measured one need not.
TEST_F(TimingTest, TheHoldIsThatWithWhichTheMotionGoes) {
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"current_A", 1.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
  folder_.write("a.csv", table);
  make({"a.csv"});
  EXPECT_EQ(read().job.recordings[0].command.hold, Hold::zero_order);
  for (std::size_t i = 0; i < table.columns[1].values.size(); ++i)
    table.columns[1].values[i] += 1e-3 * double(i % 7);
  folder_.write("b.csv", table);
  make({"b.csv"});
  EXPECT_EQ(read().job.recordings[0].command.hold, Hold::zero_order) << "though it has noise";
}

// A force that was written where it changes, beside a position of every sample.
TEST_F(TimingTest, WhatIsWrittenWhereItChangesHolds) {
  const Table table = driven();
  std::string rows = "Timestamp,Key,Value\n";
  double before = NAN;
  for (std::size_t i = 0; i < table.columns[0].values.size(); ++i) {
    const double time = table.columns[0].values[i], force = table.columns[1].values[i];
    if (force != before) rows += fmt::format("{},force_N,{}\n", time, 60.0 * force);
    rows += fmt::format("{},position_m,{}\n", time, table.columns[2].values[i]);
    before = force;
  }
  folder_.write("list.csv", rows);
  make({"list.csv"});
  const Job job = read().job;
  EXPECT_EQ(job.recordings[0].command.hold, Hold::zero_order);
  EXPECT_EQ(delay(job), nullptr);
  EXPECT_EQ(job.recordings[0].command_sigma, 0.0);
  expect_the_driven_mass(fitted(read()), 1.0);
}

constexpr double kInterval = 0.02;  // s, of a controller that logs a flywheel

/// A flywheel of 0.006 kg m^2 with 0.02 N m s/rad and 0.15 N m, driven by levels of a volt to a N m
/// and integrated in steps of a millisecond, whose velocity (rad/s) is logged by `measured`, a
/// function of the speeds up to now.
template <class Measured>
std::string flywheel(const Measured& measured) {
  Normal normal(3);
  std::string rows = "Timestamp,AppliedVolts,VelocityRadPerSec\n";
  std::vector<double> speeds{0.0};
  for (int i = 0; i < 12000; ++i) {
    const int level = i / 1500 + 1;
    const double volts = 9.0 * std::sin(2.3 * level), speed = speeds.back();
    if (i % 20 == 0)
      rows +=
          fmt::format("{:.3f},{:.6f},{:.6f}\n", 1e-3 * i, volts, measured(speeds) + 0.1 * normal());
    const double slowing = 0.02 * speed + std::copysign(0.15, speed);
    speeds.push_back(speed + 1e-3 * (volts - slowing) / 0.006);
  }
  return rows;
}

TEST_F(TimingTest, AVelocityThatIsAMeanIsFittedAsOne) {
  folder_.write("mean.csv", flywheel([](const std::vector<double>& speeds) {
                  const std::size_t n = std::min<std::size_t>(120, speeds.size());
                  double sum = 0.0;
                  for (std::size_t i = speeds.size() - n; i < speeds.size(); ++i) sum += speeds[i];
                  return sum / 120.0;
                }));
  const InitialJob made = make({"mean.csv"}, {}, 1.0);
  EXPECT_EQ(read().job.recordings[0].find(Signal::velocity)->filter.length, 6u);
  EXPECT_TRUE(std::ranges::any_of(made.guesses, [](const std::string& text) {
    return text.starts_with("VelocityRadPerSec is a mean over the last 120 ms");
  }));
  const auto found = fitted(read());
  EXPECT_NEAR(found.at("J"), 0.006, 0.002 * 0.006);
  EXPECT_NEAR(found.at("T_d"), 0.5 * 0.12 - 2.5 * kInterval, 0.1 * kInterval);
}

TEST_F(TimingTest, AVelocityThatIsLateIsNoMean) {
  folder_.write("late.csv", flywheel([](const std::vector<double>& speeds) {
                  return speeds[speeds.size() - std::min<std::size_t>(60, speeds.size())];
                }));
  make({"late.csv"}, {}, 1.0);
  const JobFile file = read();
  EXPECT_EQ(file.job.recordings[0].find(Signal::velocity)->filter, Filter());
  EXPECT_NEAR(fitted(file).at("T_d"), 0.06, 0.1 * kInterval);
}

}  // namespace
}  // namespace axisfit
