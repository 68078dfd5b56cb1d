#include "init/columns/resample.h"

#include <gtest/gtest.h>

#include <cmath>

namespace axisfit {
namespace {

using Values = std::vector<double>;

const Values kClock{1.0, NAN, 2.0, 3.0, 4.0}, kValues{10.0, 99.0, 20.0, NAN, 40.0};
const Values kTimes{0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0};

TEST(Resample, AValueHoldsUntilTheNext) {
  EXPECT_EQ(held_at(kTimes, kClock, kValues), (Values{10.0, 10.0, 10.0, 20.0, 20.0, 40.0, 40.0}));
  EXPECT_EQ(held_at({1.5, 2.5}, kClock, kValues, 0.5), (Values{10.0, 20.0}));
}

TEST(Resample, GoesStraightBetweenTheValuesThatThereAre) {
  EXPECT_EQ(interpolated_at(kTimes, kClock, kValues),
            (Values{10.0, 10.0, 15.0, 20.0, 30.0, 40.0, 40.0}));
}

TEST(Resample, OfNothingIsNothing) {
  EXPECT_TRUE(held_at(kTimes, {NAN}, {1.0}).empty());
  EXPECT_TRUE(interpolated_at(kTimes, {1.0}, {NAN}).empty());
}

}  // namespace
}  // namespace axisfit
