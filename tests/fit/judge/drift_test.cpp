#include "fit/judge/drift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "base/random.h"

namespace axisfit {
namespace {

using Series = std::vector<double>;
using Generator = std::mt19937_64;

/// Of unit variance, x[i] = phi x[i-1] + noise.
Series noise(Generator& g, std::size_t n, double phi = 0.0) {
  Series values(n);
  for (double& x : values) x = normal(g);
  for (std::size_t i = 1; i < n; ++i)
    values[i] = phi * values[i - 1] + std::sqrt(1.0 - phi * phi) * values[i];
  return values;
}

Series even_times(std::size_t n) {
  Series times(n);
  for (std::size_t i = 0; i < n; ++i) times[i] = 5.0 + 1e-3 * static_cast<double>(i);
  return times;
}

/// Counts of p-values below levels, and how well the standard errors tell the scatter.
struct Rates {
  int below_5_percent = 0, below_1_permille = 0;
  double error_ratio = 0.0;
};

Rates rates(int trials, std::size_t n, double phi, std::uint64_t seed) {
  Generator g(seed);
  const Series times = even_times(n);
  Rates r;
  double error = 0.0, scatter = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    const Drift d = drift(times, noise(g, n, phi));
    r.below_5_percent += d.p_value < 0.05;
    r.below_1_permille += d.p_value < 0.001;
    error += d.standard_error * d.standard_error;
    scatter += d.per_second * d.per_second;
  }
  r.error_ratio = std::sqrt(error / scatter);
  return r;
}

double three_sigma(int trials, double probability) {
  return 3.0 * std::sqrt(trials * probability * (1.0 - probability));
}

TEST(Drift, IsAsRareInWhiteNoiseAsItsPValueSays) {
  constexpr int kTrials = 4000;
  const Rates r = rates(kTrials, 200, 0.0, 1);
  EXPECT_LE(r.below_1_permille, kTrials * 0.001 + three_sigma(kTrials, 0.001));
  EXPECT_NEAR(r.below_5_percent, kTrials * 0.05, 1.5 * three_sigma(kTrials, 0.05));
  EXPECT_NEAR(r.error_ratio, 1.0, 0.07);
}

// Sixteen independent samples. As white noise, four in nine of these series would drift.
TEST(Drift, IsRareInColouredNoise) {
  constexpr int kTrials = 1500;
  const Rates r = rates(kTrials, 300, 0.9, 2);
  EXPECT_LE(r.below_1_permille, kTrials * 0.003 + three_sigma(kTrials, 0.003));
  EXPECT_LE(r.below_5_percent, kTrials * 0.055 + three_sigma(kTrials, 0.055));
  EXPECT_NEAR(r.error_ratio, 1.1, 0.15);
}

TEST(Drift, OfWhiteNoiseHasTheTextbooksStandardError) {
  Generator g(3);
  const Series times = even_times(1000);
  Series values = noise(g, 1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += 2.0 * (times[i] - 5.0);
  const Drift d = drift(times, values);
  const double exact = std::sqrt(12.0 / 1000.0) / 1.0;  // sigma / sqrt(n var(t)), in one second
  EXPECT_NEAR(d.standard_error, exact, 0.1 * exact);
  EXPECT_NEAR(d.per_second, 2.0, 4.0 * exact);
  EXPECT_LT(d.p_value, 1e-9);
  EXPECT_DOUBLE_EQ(d.span, d.per_second * (times.back() - times.front()));
}

TEST(Drift, MayHaveUnevenTimes) {
  Generator g(4);
  int covered = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    Series times(200), values = noise(g, 200, 0.5);
    double time = -3.0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      time += uniform(g) < 0.02 ? 5.0 : 0.1 * uniform(g);
      times[i] = time;
      values[i] += 10.0 - 0.25 * time;
    }
    const Drift d = drift(times, values);
    covered += std::abs(d.per_second + 0.25) < 2.0 * d.standard_error;
    EXPECT_DOUBLE_EQ(d.span, d.per_second * (times.back() - times.front()));
  }
  EXPECT_NEAR(covered, 0.95 * kTrials, three_sigma(kTrials, 0.95));
}

TEST(Drift, IsWhatAStepOrASlowWaveWouldBeToo) {
  Generator g(5);
  const Series times = even_times(2000);
  Series step = noise(g, 2000), wave = noise(g, 2000);
  for (std::size_t i = 0; i < times.size(); ++i) {
    step[i] += times[i] < 6.0 ? -0.5 : 0.5;
    wave[i] += std::sin(std::numbers::pi * (times[i] - 6.0) / 3.0);
  }
  EXPECT_LT(drift(times, step).p_value, 1e-3);
  EXPECT_LT(drift(times, wave).p_value, 1e-3);
}

TEST(Drift, OfALineIsThatLine) {
  const Series times = even_times(100);
  Series values;
  for (const double t : times) values.push_back(3.0 - 0.5 * t);
  const Drift d = drift(times, values);
  EXPECT_NEAR(d.per_second, -0.5, 1e-10);
  EXPECT_NEAR(d.span, -0.0495, 1e-11);
  EXPECT_LT(d.standard_error, 1e-9);
  EXPECT_LT(d.p_value, 1e-9);
}

TEST(Drift, IsNotInAConstant) {
  for (const double level : {0.0, 0.1, -1e6}) {
    const Drift d = drift(even_times(1000), Series(1000, level));
    EXPECT_NEAR(d.per_second, 0.0, 1e-12 * std::abs(level));
    EXPECT_GT(d.p_value, 0.5) << level;
  }
}

TEST(Drift, NeedsIndependentValues) {
  for (const Drift& d : {drift({}, {}), drift(Series{1.0, 2.0}, Series{1.0, 2.0}),
                         drift(Series(10, 1.0), even_times(10))}) {
    EXPECT_EQ(d.p_value, 1.0);
    EXPECT_EQ(d.standard_error, INFINITY);
    EXPECT_EQ(d.span, 0.0);
  }
  // One slow wave alone.
  const Series times = even_times(300);
  Series values;
  for (const double t : times) values.push_back(std::sin(20.0 * t));
  EXPECT_EQ(drift(times, values).p_value, 1.0);
}

}  // namespace
}  // namespace axisfit
