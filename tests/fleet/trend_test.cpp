#include "fleet/trend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/random.h"
#include "fleet/control_chart.h"

namespace axisfit {
namespace {

/// A parameter of 100 with standard errors of 0.5 to 1 and an own scatter, which follows a channel
/// by 1 per unit.
Trend course(std::uint64_t seed, std::size_t nights, double scatter, double jump = 0.0,
             std::size_t since = 0) {
  std::mt19937_64 generator(seed);
  std::vector<TrendNight> list;
  for (std::size_t i = 0; i < nights; ++i) {
    const double error = 0.5 + 0.5 * uniform(generator),
                 channel = 3.0 * std::sin(0.4 * static_cast<double>(i));
    const double value = 100.0 + channel + error * normal(generator) + scatter * normal(generator) +
                         (i >= since ? jump : 0.0);
    list.push_back({std::to_string(i), static_cast<double>(i), value, error, {channel}});
  }
  return Trend(std::move(list));
}

TEST(Trend, WhatIsLeftIsStandardNormal) {
  for (const double scatter : {0.0, 1.0, 3.0}) {
    std::vector<Trend> fleet;
    for (std::uint64_t seed = 0; seed < 60; ++seed) fleet.push_back(course(seed, 30, scatter));
    const ScatterPrior prior = prior_of(fleet);
    double sum = 0.0, square = 0.0, next = 0.0, count = 0.0;
    for (const Trend& trend : fleet) {
      const std::vector<double> z = trend.standardised(prior);
      EXPECT_EQ(z.size(), 29u);
      for (std::size_t i = 0; i < z.size(); ++i) {
        sum += z[i];
        square += z[i] * z[i];
        if (i > 0) next += z[i] * z[i - 1];
        ++count;
      }
    }
    EXPECT_NEAR(sum / count, 0.0, 4.0 / std::sqrt(count)) << scatter;
    EXPECT_NEAR(square / count, 1.0, 4.0 * std::sqrt(2.0 / count)) << scatter;
    EXPECT_NEAR(next / count, 0.0, 4.0 / std::sqrt(count)) << scatter;
  }
}

TEST(Trend, FalseAlarmsAreAsRareAsAskedFor) {
  constexpr int kAxes = 400, kNights = 30, kOneIn = 100;
  std::vector<Trend> fleet;
  for (std::uint64_t seed = 0; seed < kAxes; ++seed) fleet.push_back(course(seed, kNights, 1.0));
  const ScatterPrior prior = prior_of(fleet);
  const double threshold = threshold_for(kOneIn);
  std::size_t alarms = 0;
  for (const Trend& trend : fleet) alarms += trend.changes(prior, threshold).size();
  constexpr double kExpected = double(kAxes) * kNights / kOneIn;
  EXPECT_LT(alarms, kExpected + 4.0 * std::sqrt(kExpected));
}

TEST(Trend, AJumpIsToldSoonWithItsNightAndSize) {
  std::vector<Trend> fleet;
  for (std::uint64_t seed = 0; seed < 40; ++seed) fleet.push_back(course(seed, 30, 0.5));
  const ScatterPrior prior = prior_of(fleet);
  const double threshold = threshold_for(5000.0);
  int soon = 0, right = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto changes = course(100 + seed, 30, 0.5, 5.0, 18).changes(prior, threshold);
    ASSERT_GE(changes.size(), 1u);
    soon += changes[0].night >= 18 && changes[0].night < 21;
    right += std::abs(static_cast<double>(changes[0].since) - 18.0) <= 1.0 &&
             std::abs(changes[0].after - changes[0].before - 5.0) < 2.5 && changes[0].errors > 3.0;
  }
  EXPECT_GE(soon, 38);
  EXPECT_GE(right, 36);
}

TEST(Trend, ADriftHasARate) {
  std::vector<TrendNight> nights;
  std::mt19937_64 generator(3);
  for (int i = 0; i < 40; ++i)
    nights.push_back({std::to_string(i),
                      double(i),
                      50.0 + (i > 20 ? 0.5 * (i - 20) : 0.0) + 0.3 * normal(generator),
                      0.3,
                      {}});
  const auto changes = Trend(nights).changes(flat_prior(), threshold_for(1000.0));
  ASSERT_FALSE(changes.empty());
  EXPECT_NEAR(changes.back().per_day, 0.5, 0.15);
}

}  // namespace
}  // namespace axisfit
