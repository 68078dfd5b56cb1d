#include "sim/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace axisfit {
namespace {

constexpr double kPeriod = 1e-3;  // s

TEST(Motion, AStepBeginsAtItsTime) {
  const Schedule late = schedule_of(StepMotion{8.0, 0.25}, 1.0, kPeriod);
  EXPECT_EQ(late.value_at(0.249), 0.0);
  EXPECT_EQ(late.value_at(0.25), 8.0);
  EXPECT_EQ(schedule_of(StepMotion{8.0, 0.0}, 1.0, kPeriod).times, Samples{0.0});
}

TEST(Motion, LevelsAreHeldOneAfterTheOther) {
  const Schedule schedule = schedule_of(LevelsMotion{{1.0, -2.0, 3.0}, 0.5}, 1.5, kPeriod);
  EXPECT_EQ(schedule.times, (Samples{0.0, 0.5, 1.0}));
  EXPECT_EQ(schedule.values, (Samples{1.0, -2.0, 3.0}));
}

TEST(Motion, AChirpHasTheFrequencyOfItsInstant) {
  const SineMotion chirp{2.0, 1.0, 5.0, 0.5};
  const Schedule schedule = schedule_of(chirp, 2.0, kPeriod);
  EXPECT_EQ(schedule.times.size(), 2000u);
  for (const double t : {0.0, 0.3, 1.0, 1.7}) {
    const double cycles = t + t * t;  // integral of 1 + 2 t
    EXPECT_NEAR(schedule.value_at(t + 1e-9), 0.5 + 2.0 * std::sin(2.0 * std::numbers::pi * cycles),
                1e-9);
  }
}

TEST(Motion, ARandomSequenceHasTwoLevelsAndIsThatOfItsSeed) {
  const PrbsMotion motion{3.0, 0.1, 1.0, 7};
  const Schedule schedule = schedule_of(motion, 5.0, kPeriod);
  ASSERT_EQ(schedule.values.size(), 50u);
  int high = 0;
  for (const double v : schedule.values) {
    EXPECT_TRUE(v == 4.0 || v == -2.0) << v;
    high += v == 4.0;
  }
  EXPECT_NEAR(high, 25, 11);  // three standard deviations
  EXPECT_EQ(schedule_of(motion, 5.0, kPeriod).values, schedule.values);
  PrbsMotion other = motion;
  other.seed = 8;
  EXPECT_FALSE(schedule_of(other, 5.0, kPeriod).values == schedule.values);
}

/// Of a reference at a time, by differences.
double speed(const Reference& reference, double t) {
  constexpr double kStep = 1e-5;
  return (reference(t + kStep) - reference(t - kStep)) / (2.0 * kStep);
}

TEST(Motion, AMoveIsATrapezoidOfSpeed) {
  // Up in 0.5 s over 0.25 m, 0.5 m at 1 m/s, and down: 1.5 s.
  const Reference reference = reference_of({-1.0, 1.0, 2.0});
  EXPECT_EQ(reference(0.0), 0.0);
  EXPECT_NEAR(reference(0.25), -0.0625, 1e-12);
  EXPECT_NEAR(speed(reference, 0.25), -0.5, 1e-9);
  EXPECT_NEAR(reference(0.75), -0.5, 1e-12);
  EXPECT_NEAR(speed(reference, 0.75), -1.0, 1e-9);
  EXPECT_NEAR(speed(reference, 1.25), -0.5, 1e-9);
  EXPECT_EQ(reference(1.5), -1.0);
  EXPECT_EQ(reference(9.0), -1.0);
}

TEST(Motion, AShortMoveIsATriangleOfSpeed) {
  const Reference reference = reference_of({0.5, 10.0, 2.0});  // peak 1 m/s at 0.5 s
  EXPECT_NEAR(reference(0.5), 0.25, 1e-12);
  EXPECT_NEAR(speed(reference, 0.499), 0.998, 1e-9);
  EXPECT_NEAR(speed(reference, 0.501), 0.998, 1e-9);
  EXPECT_NEAR(reference(1.0), 0.5, 1e-12);
  EXPECT_EQ(reference_of({0.0, 1.0, 2.0})(3.0), 0.0);
}

}  // namespace
}  // namespace axisfit
