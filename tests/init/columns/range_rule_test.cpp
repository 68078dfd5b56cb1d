#include "init/columns/range_rule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

namespace axisfit {
namespace {

UnscaledColumn column(Kind kind, std::vector<double> raw) {
  UnscaledColumn made;
  made.column.kind = kind;
  made.raw = std::move(raw);
  return made;
}

std::vector<double> swing(double size, bool whole = false) {
  std::vector<double> values;
  for (int i = 0; i < 300; ++i) {
    const double x = size * std::sin(0.05 * i);
    values.push_back(whole ? std::round(x) : x);
  }
  return values;
}

TEST(RangeRule, AMotionHasTheUnitThatItsJointAndSizeSuggest) {
  for (const auto& [kind, joint, size, unit] :
       {std::tuple(Kind::position, Joint::prismatic, 0.4, "m"),
        {Kind::position, Joint::prismatic, 400.0, "mm"},
        {Kind::position, Joint::revolute, 3.0, "rad"},
        {Kind::load_position, Joint::revolute, 90.0, "deg"},
        {Kind::velocity, Joint::prismatic, 2.0, "m/s"},
        {Kind::velocity, Joint::revolute, 500.0, "deg/s"}}) {
    UnscaledColumn motion = column(kind, swing(size));
    size_motion_by_range(motion, joint, size);
    EXPECT_EQ(motion.column.unit, unit);
    EXPECT_TRUE(motion.column.guessed) << "never silently";
    EXPECT_TRUE(motion.column.sized_by_range);
  }
}

TEST(RangeRule, TheLargestOfAllRecordingsCounts) {
  UnscaledColumn small = column(Kind::position, swing(8.0));
  size_motion_by_range(small, Joint::prismatic, 120.0);
  EXPECT_EQ(small.column.unit, "mm");
}

TEST(RangeRule, WholeNumbersAreCountsOrParts) {
  UnscaledColumn counts = column(Kind::position, swing(2e5, true));
  size_motion_by_range(counts, Joint::prismatic, 2e5);
  EXPECT_EQ(counts.column.stored, "counts");
  EXPECT_TRUE(counts.column.guessed);
  UnscaledColumn turn = column(Kind::position, swing(3000.0, true));
  turn.column.overflow.wraps_after = 4096.0;
  size_motion_by_range(turn, Joint::prismatic, 3000.0);
  EXPECT_EQ(turn.column.unit, "rev");
  EXPECT_DOUBLE_EQ(turn.column.factor, 1.0 / 4096.0);
  EXPECT_NEAR(turn.size, 2.0 * M_PI / 4096.0, 1e-12);
}

TEST(RangeRule, ADutyIsAPartOfARegister) {
  for (const auto& [size, whole, factor, unit] : {std::tuple(0.8, false, 1.0, "1"),
                                                  {60.0, false, 1.0, "%"},
                                                  {220.0, true, 1.0 / 255.0, "1"},
                                                  {900.0, true, 1.0 / 1023.0, "1"}}) {
    UnscaledColumn duty = column(Kind::command, swing(size, whole));
    size_duty_by_range(duty);
    EXPECT_EQ(duty.column.stored, unit) << size;
    EXPECT_DOUBLE_EQ(duty.column.factor, unit == std::string("%") ? 1.0 : factor) << size;
    EXPECT_TRUE(duty.column.guessed);
  }
}

TEST(RangeRule, ATimeHasAnIntervalThatARecorderMayHave) {
  for (const auto& [interval, samples, unit] : {std::tuple(0.001, 500, "s"),
                                                {1.0, 500, "ms"},
                                                {100.0, 500, "us"},
                                                {1e6, 500, "ns"},
                                                {0.1, 600, "s"},
                                                {0.1, 20000, "ms"}}) {
    std::vector<double> raw;
    for (int i = 0; i < samples; ++i) raw.push_back(interval * i);
    UnscaledColumn time = column(Kind::time, raw);
    size_time_by_interval(time);
    EXPECT_EQ(time.column.unit, unit) << interval;
    EXPECT_TRUE(time.column.guessed);
  }
}

TEST(RangeRule, AVoltageThatHardlyChangesIsASupply) {
  std::vector<double> sags(300, 12.0);
  for (std::size_t i = 0; i < sags.size(); ++i) sags[i] -= 0.3 * std::sin(0.1 * double(i));
  EXPECT_TRUE(is_supply(Kind::motor_voltage, sags));
  EXPECT_FALSE(is_supply(Kind::motor_voltage, swing(12.0)));
  EXPECT_FALSE(is_supply(Kind::current, sags));
  EXPECT_FALSE(is_supply(Kind::command, std::vector<double>(300, 12.0))) << "that of a step";
}

}  // namespace
}  // namespace axisfit
