#include "fit/search/resonances.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "base/random.h"

namespace axisfit {
namespace {

constexpr double kInterval = 2e-3;  // s

/// White noise beside modes of these frequencies (Hz), with a damping ratio of a hundredth, that
/// another white noise shakes.
std::vector<double> ringing(const std::vector<double>& frequencies, std::size_t samples) {
  std::mt19937_64 generator(1);
  std::vector<double> sum(samples);
  for (double& x : sum) x = normal(generator);
  for (const double f : frequencies) {
    const double w = 2.0 * std::numbers::pi * f * kInterval, r = std::exp(-0.01 * w);
    double last = 0.0, before = 0.0;
    for (double& x : sum) {
      const double now =
          2.0 * r * std::cos(w) * last - r * r * before + std::sin(w) * normal(generator);
      x += now;
      before = std::exchange(last, now);
    }
  }
  return sum;
}

TEST(Resonances, AreWhereItRings) {
  std::vector<double> found = resonances_in(ringing({9.3, 41.0}, 3000), kInterval, 2);
  ASSERT_EQ(found.size(), 2u);
  std::ranges::sort(found);
  // To three of their half widths.
  EXPECT_NEAR(found[0], 9.3, 0.03 * 9.3);
  EXPECT_NEAR(found[1], 41.0, 0.03 * 41.0);
}

TEST(Resonances, AreNoTwoPeaksOfOne) {
  const std::vector<double> found = resonances_in(ringing({9.3}, 3000), kInterval, 5);
  ASSERT_EQ(found.size(), 5u);
  EXPECT_NEAR(found[0], 9.3, 0.03 * 9.3);
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GT(std::abs(std::log(found[i] / found[j])), std::log(1.1));
}

TEST(Resonances, AreNoneOfAFewValues) {
  EXPECT_TRUE(resonances_in(ringing({9.3}, 31), kInterval, 2).empty());
}

}  // namespace
}  // namespace axisfit
