#include "io/recording/counters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace axisfit {
namespace {

TEST(Unwrap, GoesOnWhereACounterBeginsAnew) {
  std::vector<double> angle{300.0, 350.0, 20.0, 100.0, 10.0, 340.0, 290.0};
  unwrap(angle, 360.0);
  EXPECT_EQ(angle, (std::vector<double>{300.0, 350.0, 380.0, 460.0, 370.0, 340.0, 290.0}));
}

TEST(Unwrap, TakesTheShortestStep) {
  std::vector<double> up{0.0, 179.0}, down{0.0, 181.0};
  unwrap(up, 360.0);
  unwrap(down, 360.0);
  EXPECT_EQ(up.back(), 179.0);
  EXPECT_EQ(down.back(), -179.0);
}

TEST(Unwrap, LeavesOutWhatIsMissing) {
  std::vector<double> values{NAN, 350.0, NAN, 10.0};
  unwrap(values, 360.0);
  EXPECT_TRUE(std::isnan(values[0]) && std::isnan(values[2]));
  EXPECT_EQ(values[1], 350.0);
  EXPECT_EQ(values[3], 370.0);
}

TEST(RestoreSign, IsThatOfTheHighestBit) {
  std::vector<double> values{0.0, 32767.0, 32768.0, 65535.0};
  restore_sign(values, 16);
  EXPECT_EQ(values, (std::vector<double>{0.0, 32767.0, -32768.0, -1.0}));
}

}  // namespace
}  // namespace axisfit
