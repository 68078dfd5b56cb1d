#include "fit/data/derivative.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "base/random.h"

namespace axisfit {
namespace {

constexpr double kInterval = 2e-3, kW = 12.0;  // s, rad/s

/// sin(w t) with noise and its derivative, of which the largest error away from the ends is told.
double worst_error(int order, double noise) {
  std::mt19937_64 generator(3);
  std::vector<double> values;
  for (int i = 0; i < 4000; ++i)
    values.push_back(std::sin(kW * i * kInterval) + noise * normal(generator));
  const std::vector<double> found = derivative(values, kInterval, order);
  EXPECT_EQ(found.size(), values.size());
  double worst = 0.0;
  for (std::size_t i = 500; i + 500 < values.size(); ++i) {
    const double phase = kW * static_cast<double>(i) * kInterval;
    const double truth = order == 1 ? kW * std::cos(phase) : -kW * kW * std::sin(phase);
    worst = std::max(worst, std::abs(found[i] - truth));
  }
  return worst / std::pow(kW, order);
}

TEST(Derivative, OfASmoothSignalIsThatOfTheSignal) {
  EXPECT_LT(worst_error(1, 0.0), 1e-3);
  EXPECT_LT(worst_error(2, 0.0), 1e-3);
}

// Five standard deviations of noise that makes 3 % of it.
TEST(Derivative, LetsThroughLittleNoise) {
  for (const double noise : {1e-5, 1e-3, 1e-2}) {
    EXPECT_LT(worst_error(1, noise), 5 * 0.03) << noise;
    EXPECT_LT(worst_error(2, noise), 5 * 0.03) << noise;
  }
}

TEST(EvenGrid, InterpolatesBetweenTimes) {
  const std::vector<double> times{0.0, 1.0, 4.0};
  const std::vector<double> values{1.0, 2.0, 5.0};
  EXPECT_EQ(on_even_grid(times, values), (std::vector<double>{1.0, 3.0, 5.0}));
  // Earlier by a delay; constant before the first.
  EXPECT_EQ(on_even_grid(times, values, 1.0), (std::vector<double>{1.0, 2.0, 4.0}));
}

}  // namespace
}  // namespace axisfit
