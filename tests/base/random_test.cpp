#include "base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace axisfit {
namespace {

// The standard fixes the numbers of the generator: the first of mt19937_64 is 14514284786278117030.
TEST(Random, UniformNumbersAreThoseOfTheGenerator) {
  std::mt19937_64 generator;
  EXPECT_NEAR(uniform(generator), 14514284786278117030.0 / 0x1p64, 0x1p-53);
}

TEST(Random, UniformNumbersFillTheIntervalAndNeverReachOne) {
  std::mt19937_64 generator(1);
  std::vector<double> values(20000);
  for (double& x : values) x = uniform(generator);
  const auto [low, high] = std::ranges::minmax(values);
  EXPECT_GE(low, 0.0);
  EXPECT_LT(high, 1.0);
  EXPECT_LT(low, 1e-3);
  EXPECT_GT(high, 1.0 - 1e-3);
}

TEST(Random, NormalNumbersHaveTheMomentsOfTheirDistribution) {
  std::mt19937_64 generator(2);
  constexpr int kNumbers = 100000;
  double sum = 0.0, square = 0.0, fourth = 0.0;
  for (int i = 0; i < kNumbers; ++i) {
    const double x = normal(generator);
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
  }
  // Within four standard errors: those of the moments are sqrt(1 / n), sqrt(2 / n), sqrt(96 / n).
  const auto within = [](double variance) { return 4.0 * std::sqrt(variance / kNumbers); };
  EXPECT_NEAR(sum / kNumbers, 0.0, within(1.0));
  EXPECT_NEAR(square / kNumbers, 1.0, within(2.0));
  EXPECT_NEAR(fourth / kNumbers, 3.0, within(96.0));
}

}  // namespace
}  // namespace axisfit
