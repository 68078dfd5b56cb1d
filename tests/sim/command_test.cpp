#include "sim/command.h"

#include <gtest/gtest.h>

#include <vector>

namespace axisfit {
namespace {

const std::vector<double> kTimes{0.0, 1.0, 2.0, 3.0, 4.0}, kValues{2.0, 2.0, 2.0, 6.0, 6.0};

TEST(Schedule, OfACommandHoldsWhatChanges) {
  const Schedule schedule = schedule_from_samples(kTimes, kValues);
  EXPECT_EQ(schedule.times, (Samples{0.0, 3.0}));
  EXPECT_EQ(schedule.values, (Samples{2.0, 6.0}));
}

TEST(Schedule, OfWhatWasMeasuredKeepsBothEndsOfALevel) {
  const Schedule schedule = schedule_from_samples(kTimes, kValues, Hold::linear);
  EXPECT_EQ(schedule.times, (Samples{0.0, 2.0, 3.0, 4.0}));
  for (const double t : {0.0, 0.5, 1.5, 2.0}) EXPECT_EQ(schedule.value_at(t), 2.0) << t;
  EXPECT_EQ(schedule.value_at(2.25), 3.0);
  EXPECT_EQ(schedule.value_at(3.5), 6.0);
}

TEST(Schedule, BeforeItsBeginningIsZeroOrItsFirstValue) {
  Schedule schedule = schedule_from_samples({1.0, 2.0}, {3.0, 5.0});
  EXPECT_EQ(schedule.value_at(0.999), 0.0);
  EXPECT_EQ(schedule.value_at(1.0), 3.0);
  schedule.hold = Hold::linear;
  EXPECT_EQ(schedule.value_at(-7.0), 3.0);
  EXPECT_EQ(Schedule().value_at(1.0), 0.0);
}

TEST(Schedule, BehindItsEndKeepsItsLastValue) {
  for (const Hold hold : {Hold::zero_order, Hold::linear}) {
    const Schedule schedule = schedule_from_samples({1.0, 2.0}, {3.0, 5.0}, hold);
    EXPECT_EQ(schedule.value_at(9.0), 5.0);
    EXPECT_EQ(schedule.slope_after(0), hold == Hold::linear ? 2.0 : 0.0);
    EXPECT_EQ(schedule.slope_after(1), 0.0);
  }
}

}  // namespace
}  // namespace axisfit
