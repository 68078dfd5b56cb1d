#include "base/rounding.h"

#include <gtest/gtest.h>

#include <cmath>

namespace axisfit {
namespace {

TEST(Rounding, KeepsSignificantDigits) {
  EXPECT_EQ(round_to_digits(1234.5, 2), 1200.0);
  EXPECT_EQ(round_to_digits(-0.0012345, 3), -0.00123);
  EXPECT_EQ(round_to_digits(9.96, 2), 10.0);
  EXPECT_EQ(round_to_digits(0.0, 3), 0.0);
}

TEST(Rounding, TakesNumbersOfAnySize) {
  EXPECT_EQ(round_to_digits(5e-324, 1), 5e-324);
  EXPECT_EQ(round_to_digits(1.7321e308, 2), 1.7e308);
  EXPECT_EQ(round_to_digits(-INFINITY, 2), -INFINITY);
}

TEST(Percent, HasNoExponentAboveOne) {
  EXPECT_EQ(percent(0.0), "0 %");
  EXPECT_EQ(percent(33.46), "33 %");
  EXPECT_EQ(percent(99.6), "100 %");
  EXPECT_EQ(percent(123.4), "123 %");
  EXPECT_EQ(percent(123.4, 3), "123 %");
  EXPECT_EQ(percent(45678.9, 3), "45679 %");
  EXPECT_EQ(percent(0.0000123), "1.2e-05 %");
  EXPECT_EQ(percent(NAN), "nan %");
}

}  // namespace
}  // namespace axisfit
