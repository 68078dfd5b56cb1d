#include "fit/data/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace axisfit {
namespace {

std::vector<double> smooth_signal(std::size_t n) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    values.push_back(std::sin(12.0 * t) + 0.05 * std::sin(480.0 * t));  // a gear ringing at 76 Hz
  }
  return values;
}

TEST(Noise, IsFoundUnderAMovingSignal) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal(0.0, 2e-3);
  std::vector<double> values = smooth_signal(4000);
  for (double& x : values) x += normal(generator);
  EXPECT_NEAR(noise_from_differences(values), 2e-3, 0.05 * 2e-3);
}

TEST(Noise, IgnoresASmoothSignal) {
  // The sixth difference of the ringing, (480e-3)^6 * 0.05 / sqrt(924), is all that is left.
  EXPECT_LT(noise_from_differences(smooth_signal(4000)), 2e-5);
}

TEST(Noise, SurvivesJumps) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal(0.0, 2e-3);
  std::vector<double> values(4000);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = normal(generator) + (i / 200 % 2 == 0 ? 0.0 : 5.0);
  EXPECT_NEAR(noise_from_differences(values), 2e-3, 0.1 * 2e-3);
}

TEST(Noise, OfAnEncoderIsItsRounding) {
  std::vector<double> values = smooth_signal(4000);
  const double count = 5e-4;
  for (double& x : values) x = count * std::floor(x / count);
  EXPECT_NEAR(resolution_of(values), count, 1e-9);
  const double rounding = count / std::sqrt(12.0);
  EXPECT_GE(noise_from_differences(values), rounding * (1.0 - 1e-9));
  EXPECT_LE(noise_from_differences(values), 1.25 * rounding);
  // So slow that most differences are zero.
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = count * std::floor(0.02 * static_cast<double>(i));
  EXPECT_NEAR(noise_from_differences(values), rounding, 1e-9 * rounding);
}

TEST(Noise, HasNoGridInRealNumbers) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<double> values(1000);
  for (double& x : values) x = normal(generator);
  EXPECT_EQ(resolution_of(values), 0.0);
}

// A simulation, or a drive that is off: the same value again and again for most of the time.
TEST(Noise, OfASignalThatIsFrozenAtRestIsThatOfItsMotion) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal(0.0, 2e-3);
  std::vector<double> values = smooth_signal(4000);
  for (double& x : values) x += normal(generator);
  values.insert(values.end(), 3 * values.size(), values.back());
  EXPECT_NEAR(noise_from_differences(values), 2e-3, 0.05 * 2e-3);
}

// The median lies between differences that are zero and those that are so but for the computer's
// rounding.
TEST(Noise, OfASignalThatRestsHalfTheTimeIsThatOfItsDigits) {
  for (int rest = 450; rest < 550; ++rest) {
    std::vector<double> values;
    for (int i = 0; i < 1000; ++i)
      values.push_back(std::round(1e9 * (1.0 - std::cos(4.7e-3 * std::max(0, i - rest)))) / 1e9);
    EXPECT_GT(noise_from_differences(values), 3e-11) << rest;
    EXPECT_LT(noise_from_differences(values), 4e-10) << rest;
  }
}

TEST(Noise, OfAConstantIsZero) {
  EXPECT_EQ(noise_from_differences(std::vector<double>(100, 3.0)), 0.0);
  EXPECT_EQ(noise_from_differences(std::vector<double>{1.0, 2.0, 1.0}), 0.0);
}

// Its steps are equal, as those of a grid, but nothing was rounded to them.
TEST(Noise, OfARampIsThatOfItsDigits) {
  std::vector<double> ramp(500);
  for (std::size_t i = 0; i < ramp.size(); ++i)
    ramp[i] = std::round(2.5e-3 * static_cast<double>(i) * 1e6) / 1e6 + (i % 3 == 0 ? 1e-6 : 0.0);
  EXPECT_LT(noise_of_input(ramp), 3e-6);
  EXPECT_GT(noise_from_differences(ramp), 5e-4) << "of an encoder it could be";
}

TEST(Noise, OfAnInputIsNoneWhereSomebodyChoseItsValues) {
  std::vector<double> levels(1000);
  for (std::size_t i = 0; i < levels.size(); ++i) levels[i] = i / 100 % 2 == 0 ? 5.0 : -5.0;
  EXPECT_GT(noise_from_differences(levels), 1.0);  // of its grid
  EXPECT_EQ(noise_of_input(levels), 0.0);
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal(0.0, 0.01);
  for (double& x : levels) x += normal(generator);
  EXPECT_NEAR(noise_of_input(levels), 0.01, 2e-3);
  for (double& x : levels) x = 300.0 * normal(generator);  // as a log of what changes has them
  EXPECT_EQ(noise_of_input(levels), 0.0);
}

}  // namespace
}  // namespace axisfit
