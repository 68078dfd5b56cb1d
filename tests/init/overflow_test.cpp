#include "init/overflow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <tuple>
#include <vector>

namespace axisfit {
namespace {

/// Two turns to and fro, as an encoder of one turn shows them; the last value is missing.
std::vector<double> wrapped(double turn, bool whole) {
  std::vector<double> values;
  for (int i = 0; i < 500; ++i) {
    double x = turn * (0.3 + 2.0 * std::sin(0.02 * i));
    if (whole) x = std::floor(x);
    values.push_back(x - turn * std::floor(x / turn));
  }
  values.push_back(NAN);
  return values;
}

TEST(OverflowTest, AnEncoderOfOneTurnIsMadeContinuous) {
  const std::optional<double> unknown;
  for (const auto& [turn, known, unit, whole] :
       {std::tuple(360.0, std::optional(360.0), "deg", false),
        {2.0 * M_PI, 2.0 * M_PI, "rad", false},
        {1.0, 1.0, "rev", false},
        {4096.0, unknown, "counts", true},
        {4096.0, 4096.0, "rev", true},   // of a column in rev/4096
        {65536.0, 4096.0, "rev", true},  // a counter of 16 bits, of so many to a turn
        {65536.0, unknown, "um", true},
        {65536.0, unknown, "", true},
        {360.0, unknown, "", false}}) {
    std::vector<double> values = wrapped(turn, whole);
    const Overflow found = overflow_of(values, Kind::position, known, unit);
    EXPECT_DOUBLE_EQ(found.wraps_after, turn) << unit;
    EXPECT_EQ(found.signed_bits, 0);
    found.undo(values);
    for (int i = 0; i < 500; ++i)
      EXPECT_NEAR(values[static_cast<std::size_t>(i)], turn * (0.3 + 2.0 * std::sin(0.02 * i)),
                  whole ? 1.0 : 1e-9 * turn);
    EXPECT_TRUE(std::isnan(values.back()));
  }
}

TEST(OverflowTest, WhatDoesNotLeapByATurnIsLeftAlone) {
  std::vector<double> swing, step;
  for (int i = 0; i < 500; ++i) {
    swing.push_back(180.0 + 179.0 * std::sin(0.02 * i));
    step.push_back(i < 250 ? 0.0 : 350.0);
  }
  for (const auto& values : {swing, step})
    EXPECT_EQ(overflow_of(values, Kind::position, {}, "mm").wraps_after, 0.0);
  EXPECT_FALSE(overflow_of(swing, Kind::position, 360.0, "deg").any());
  EXPECT_FALSE(overflow_of(wrapped(360.0, false), Kind::velocity, {}).any()) << "no position";
}

TEST(OverflowTest, IntegersGetTheirSignBack) {
  std::vector<double> values{3, 10, 65535, 65530, 885, 64651, 0};
  const Overflow found = overflow_of(values, Kind::command, {});
  EXPECT_EQ(found.signed_bits, 16);
  found.undo(values);
  EXPECT_EQ(values, (std::vector<double>{3, 10, -1, -6, 885, -885, 0}));
  EXPECT_FALSE(overflow_of({3, 10, 40000, 65530}, Kind::command, {}).any()) << "a large value";
  EXPECT_FALSE(overflow_of({3.5, 65535}, Kind::command, {}).any()) << "no integers";
}

}  // namespace
}  // namespace axisfit
