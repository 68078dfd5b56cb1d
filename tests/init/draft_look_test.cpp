#include "init/draft_look.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/init/made_job.h"

namespace axisfit {
namespace {

class DraftLookTest : public InitJobTest {
 protected:
  const FreeParameter* delay(const Job& job) {
    const auto found = std::ranges::find(job.free, quantity_index("T_d"), &FreeParameter::quantity);
    return found == job.free.end() ? nullptr : &*found;
  }
};

TEST_F(DraftLookTest, GivesTheInitialValues) {
  folder_.write("a.csv", driven());
  const InitialJob made = make({"a.csv"}, {}, 60.0);
  ASSERT_TRUE(made.look);
  EXPECT_NEAR(60.0 * made.look->mass.value, 12.0, 1.0);
  const Job job = read().job;
  const auto initial = [&](const char* name) {
    return std::ranges::find(job.free, quantity_index(name), &FreeParameter::quantity)->initial;
  };
  EXPECT_NEAR(initial("M"), 12.0, 1.0);
  EXPECT_NEAR(initial("B_a"), 40.0, 8.0);
}

TEST_F(DraftLookTest, IsForWhatAForceDrives) {
  folder_.write(
      "a.csv", "t_s,set_velocity_v,velocity_mps\n" + [] {
        std::string rows;
        for (int i = 0; i < 200; ++i)
          rows += std::to_string(0.001 * i) + "," + std::to_string(i / 20 % 3) + "," +
                  std::to_string(0.01 * (i % 7)) + "\n";
        return rows;
      }());
  EXPECT_FALSE(make({"a.csv"}).look);
}

// The position is logged three samples after what drives it.
TEST_F(DraftLookTest, ALateLogFreesTheDelay) {
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
TEST_F(DraftLookTest, TheHoldIsThatWithWhichTheMotionGoes) {
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
TEST_F(DraftLookTest, WhatIsWrittenWhereItChangesHolds) {
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

TEST_F(DraftLookTest, AMotionOneWayIsSlowedByFriction) {
  folder_.write("forward.csv", driven(1, {{2.0, 1.0, 1.5, 0.7, 1.8, 1.2}, 0.3}));
  const InitialJob made = make({"forward.csv"}, {}, 60.0);
  ASSERT_TRUE(made.look);
  EXPECT_EQ(made.look->constant.value, 0.0);
  EXPECT_EQ(std::ranges::count(read().job.free, quantity_index("constant_force.F_0"),
                               &FreeParameter::quantity),
            0);
  EXPECT_NEAR(fitted(read()).at("coulomb_friction.F_c"), 15.0 - 4.0, 1.0) << "less what pushes";
}

TEST_F(DraftLookTest, AHardStopIsLeftOut) {
  Table table = driven(1, {{1.0, -1.0, 2.0}, 0.3});
  constexpr std::size_t kFree = 450, kAll = 650;
  table.columns.resize(3);
  for (Column& column : table.columns) {
    column.values.resize(kFree);
    column.values.resize(kAll, column.values.back());
  }
  for (std::size_t i = kFree; i < kAll; ++i) {
    table.columns[0].values[i] = 0.002 * static_cast<double>(i);
    table.columns[1].values[i] = 2.0;  // it pushes on
  }
  folder_.write("a.csv", table);
  const InitialJob made = make({"a.csv"}, {}, 60.0);
  const JobFile file = read();
  EXPECT_NEAR(file.job.recordings[0].times.back(), 0.9, 0.01);
  EXPECT_TRUE(std::ranges::any_of(made.guesses, [](const std::string& text) {
    return text.starts_with("a ends on a hard stop at 0.9");
  }));
  EXPECT_NEAR(fitted(file).at("M"), 12.0, 0.3);
}

}  // namespace
}  // namespace axisfit
