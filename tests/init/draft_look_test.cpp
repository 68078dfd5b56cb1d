#include "init/draft_look.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/init/made_job.h"

namespace axisfit {
namespace {

using DraftLookTest = InitJobTest;

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
