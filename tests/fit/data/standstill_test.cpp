#include "fit/data/standstill.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "io/recording/csv.h"

namespace axisfit {
namespace {

constexpr double kStep = 1e-3;           // s, between samples
constexpr double kVelocityNoise = 2e-3;  // m/s
constexpr double kPositionNoise = 1e-5;  // m
constexpr std::size_t kSamples = 2000;

struct Phase {
  double begin, end;  // s
};

double velocity_at(double t, double moving, const std::vector<Phase>& rests) {
  for (const Phase& standstill : rests)
    if (t >= standstill.begin && t < standstill.end) return 0.0;
  return moving;
}

Measurement measurement(Signal signal, double sigma, std::vector<double> values = {}) {
  Measurement m;
  m.signal = signal;
  m.sigma = sigma;
  m.values = std::move(values);
  return m;
}

/// Motion at one speed (m/s) but for its rests, as velocity, position and acceleration.
Recording recorded(double moving, const std::vector<Phase>& rests, std::uint64_t seed = 1) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  Recording recording;
  Measurement velocity = measurement(Signal::velocity, kVelocityNoise);
  Measurement position = measurement(Signal::position, kPositionNoise);
  Measurement acceleration = measurement(Signal::acceleration, 0.05);
  double y = 0.3;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double t = kStep * static_cast<double>(k);
    const double v = velocity_at(t, moving, rests);
    recording.times.edit().push_back(t);
    velocity.values.edit().push_back(v + kVelocityNoise * normal(generator));
    position.values.edit().push_back(y + kPositionNoise * normal(generator));
    acceleration.values.edit().push_back(0.05 * normal(generator));
    y += v * kStep;
  }
  recording.measurements = {velocity, position, acceleration};
  return recording;
}

Recording without(Recording recording, Signal signal) {
  std::erase_if(recording.measurements, [&](const Measurement& m) { return m.signal == signal; });
  return recording;
}

/// Share of the samples of a phase that are said to rest.
double share(const std::vector<bool>& standstill, Phase phase) {
  const auto at = [](double t) { return static_cast<std::ptrdiff_t>(std::lround(t / kStep)); };
  const auto begin = standstill.begin() + at(phase.begin), end = standstill.begin() + at(phase.end);
  return static_cast<double>(std::count(begin, end, true)) / static_cast<double>(end - begin);
}

/// Half of the window in which the mean is taken.
constexpr double kHalf = 12 * kStep;

TEST(Standstill, IsFoundByTheVelocityOrElseThePosition) {
  const std::vector<Phase> rests{{0.0, 0.3}, {0.8, 1.2}, {1.7, 2.0}};
  const Recording both = recorded(0.2, rests);
  for (const Recording& recording :
       {both, without(both, Signal::position), without(both, Signal::velocity)}) {
    const std::vector<bool> standstill = at_standstill(recording);
    ASSERT_EQ(standstill.size(), kSamples);
    // Up to the ends of the recording, and nowhere in motion; a window at the border sees both.
    EXPECT_GT(share(standstill, {0.0, 0.3 - kHalf}), 0.99);
    EXPECT_EQ(share(standstill, {0.3 + kHalf, 0.8 - kHalf}), 0.0);
    EXPECT_GT(share(standstill, {0.8 + kHalf, 1.2 - kHalf}), 0.99);
    EXPECT_EQ(share(standstill, {1.2 + kHalf, 1.7 - kHalf}), 0.0);
    EXPECT_GT(share(standstill, {1.7 + kHalf, 2.0}), 0.99);
  }
}

TEST(Standstill, IsHardlyEverMissedUnderNoise) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Recording recording = recorded(0.0, {}, seed);
    EXPECT_GT(share(at_standstill(recording), {0.0, 2.0}), 0.97) << seed;
  }
}

TEST(Standstill, IsNotSlowMotion) {
  // Less than the noise of one sample, more than that of the mean over 25.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Recording recording = recorded(1.3 * kVelocityNoise, {}, seed);
    EXPECT_EQ(share(at_standstill(recording), {0.0, 2.0}), 0.0) << seed;
    const Recording by_position =
        without(recorded(10.0 * kPositionNoise / (24 * kStep), {}, seed), Signal::velocity);
    EXPECT_EQ(share(at_standstill(by_position), {0.0, 2.0}), 0.0) << seed;
  }
}

TEST(Standstill, IsNotAShortPauseNorATurn) {
  const Recording pause = recorded(0.2, {{1.0, 1.04}});
  EXPECT_EQ(share(at_standstill(pause), {0.0, 2.0}), 0.0);
  Recording turn = recorded(0.0, {});
  for (std::size_t k = 0; k < kSamples; ++k)
    turn.measurements[0].values.edit()[k] += 2.0 * (turn.times[k] - 1.0);
  EXPECT_EQ(share(at_standstill(turn), {0.0, 2.0}), 0.0);
  // As long as twice the window it counts.
  const Recording standstill = recorded(0.2, {{1.0, 1.1}});
  EXPECT_GT(share(at_standstill(standstill), {1.0 + kHalf, 1.1 - kHalf}), 0.99);
}

TEST(Standstill, IsUnknownWithoutVelocityAndPosition) {
  const Recording recording =
      without(without(recorded(0.0, {}), Signal::velocity), Signal::position);
  EXPECT_TRUE(at_standstill(recording).empty());
  Recording shorter = recorded(0.0, {});
  shorter.times.edit().resize(40);
  for (Measurement& m : shorter.measurements) m.values.edit().resize(40);
  EXPECT_TRUE(at_standstill(shorter).empty());
}

TEST(Standstill, LeavesOutTheAccelerationAlone) {
  Recording recording = recorded(0.2, {{1.0, 2.0}});
  exclude_acceleration_at_standstill(recording);
  for (const Measurement& m : recording.measurements) {
    EXPECT_TRUE(m.counts(500));
    EXPECT_EQ(m.counts(1500), m.signal != Signal::acceleration);
  }
  Recording unknown = without(without(recording, Signal::velocity), Signal::position);
  exclude_acceleration_at_standstill(unknown);
  EXPECT_TRUE(unknown.measurements[0].counts(1500));
}

TEST(Standstill, OfTheCleanRecordingComesAfterItsStep) {
  const Table table = read_csv(std::string(AXISFIT_TESTDATA) + "/clean-fit.csv");
  Recording recording;
  recording.times = table.columns[0].values;
  for (const auto& [column, signal, sigma] :
       {std::tuple{"velocity_mps", Signal::velocity, 2e-3},
        std::tuple{"position_m", Signal::position, 9e-6 / std::sqrt(12.0)}})
    recording.measurements.push_back(measurement(signal, sigma, table.find(column)->values));
  // The position is that of the motor, which rests while the arm still rings against it.
  for (const auto& [by, begin] :
       {std::pair{recording, 2120.0}, std::pair{without(recording, Signal::velocity), 1970.0}}) {
    const std::vector<bool> standstill = at_standstill(by);
    ASSERT_EQ(standstill.size(), 2501U);
    const auto first = std::ranges::find(standstill, true) - standstill.begin();
    std::cout << "rest from " << first << " ms\n";
    EXPECT_NEAR(static_cast<double>(first), begin, 25.0);
    EXPECT_EQ(std::find(standstill.begin() + first, standstill.end(), false), standstill.end());
  }
}

TEST(NoiseAtRest, IsWhatTheInstrumentsShowThere) {
  Recording recording = recorded(0.1, {{0.3, 0.9}, {1.4, 2.0}});
  // An offset that differs between rests is no noise, nor is motion.
  for (std::size_t k = 1000; k < kSamples; ++k) recording.measurements[2].values.edit()[k] += 3.0;
  for (std::size_t k = 0; k < 250; ++k) recording.measurements[2].values.edit()[k] *= 10.0;
  EXPECT_NEAR(noise_at_standstill(recording, recording.measurements[2]), 0.05, 0.05 * 0.1);
  EXPECT_NEAR(noise_at_standstill(recording, recording.measurements[0]), kVelocityNoise,
              0.1 * kVelocityNoise);
  const Recording moving = recorded(0.1, {});
  EXPECT_EQ(noise_at_standstill(moving, moving.measurements[2]), 0.0);
}

TEST(NoiseAtRest, IsTheSampleStandardDeviation) {
  constexpr std::size_t kFew = 60;
  Recording recording;
  Measurement acceleration = measurement(Signal::acceleration, 1.0);
  for (std::size_t k = 0; k < kFew; ++k) {
    recording.times.edit().push_back(kStep * static_cast<double>(k));
    acceleration.values.edit().push_back(k % 2 == 0 ? 1.0 : 3.0);
  }
  recording.measurements = {
      measurement(Signal::velocity, kVelocityNoise, std::vector<double>(kFew, 0.0)), acceleration};
  EXPECT_NEAR(noise_at_standstill(recording, acceleration), std::sqrt(60.0 / 59.0), 1e-12);
}

TEST(ExcludedSamples, TellWhatWasMeasuredThere) {
  Measurement biased;
  biased.values = {1.0, 0.2, 0.2};
  biased.sigma = 0.05;
  EXPECT_FALSE(excluded_samples(biased).has_value());
  biased.excluded = {false, true, true};
  ASSERT_TRUE(excluded_samples(biased).has_value());
  EXPECT_EQ(excluded_samples(biased)->samples, 2u);
  EXPECT_DOUBLE_EQ(excluded_samples(biased)->mean, 0.2);
  EXPECT_FALSE(excluded_samples(biased)->is_within_noise);
  biased.sigma = 0.1;
  EXPECT_TRUE(excluded_samples(biased)->is_within_noise);
}

}  // namespace
}  // namespace axisfit
