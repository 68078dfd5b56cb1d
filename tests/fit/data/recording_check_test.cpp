// What recordings show by themselves, on motions whose every number is known.
#include "fit/data/recording_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>

namespace axisfit {
namespace {

constexpr std::size_t kSamples = 2000;
constexpr double kInterval = 1e-3;
constexpr double kRate = 2.0 * std::numbers::pi * 1.3;  // rad/s of the motion

/// A sine of 0.1 m with noise in the velocity and a bias in the acceleration.
Recording moving() {
  Recording recording;
  recording.name = "sine";
  std::mt19937_64 generator(1);
  std::normal_distribution<double> noise;
  Measurement position, velocity, acceleration;
  position.signal = Signal::position;
  velocity.signal = Signal::velocity;
  acceleration.signal = Signal::acceleration;
  std::tie(position.sigma, velocity.sigma, acceleration.sigma) = std::tuple(1e-5, 2e-3, 0.05);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double t = kInterval * static_cast<double>(i), phase = kRate * t;
    recording.times.edit().push_back(t);
    position.values.edit().push_back(0.1 * std::sin(phase) + 1e-5 * noise(generator));
    velocity.values.edit().push_back(0.1 * kRate * std::cos(phase) + 2e-3 * noise(generator));
    acceleration.values.edit().push_back(-0.1 * kRate * kRate * std::sin(phase) + 9.81 +
                                         0.05 * noise(generator));
  }
  recording.command = {{0.0, 0.5, 1.0}, {2.0, -3.0, 1.0}};
  recording.measurements = {position, velocity, acceleration};
  return recording;
}

// A current that is measured: noisy, and cut off at 2 A.
TEST(RecordingCheckTest, SeesAMeasuredInputAtTheEndOfItsRange) {
  Recording recording = moving();
  std::mt19937_64 generator(2);
  std::normal_distribution<double> noise;
  std::size_t beyond = 0;
  const auto measured = [&](double range) {
    Schedule current;
    current.hold = Hold::linear;
    beyond = 0;
    for (const double t : recording.times) {
      const double value = 3.0 * std::sin(5.0 * t) + 0.02 * noise(generator);
      beyond += std::abs(value) > range ? 1 : 0;
      current.times.edit().push_back(t);
      current.values.edit().push_back(std::clamp(value, -range, range));
    }
    return current;
  };
  recording.command = measured(2.0);
  const ValueCheck clipped = check_recording(recording).command;
  EXPECT_EQ(clipped.clipped_at, 2.0);
  EXPECT_EQ(clipped.clipped, beyond);
  // What a drive was told may well end so.
  recording.command.hold = Hold::zero_order;
  EXPECT_EQ(check_recording(recording).command.clipped, 0u);
  recording.command = measured(10.0);
  EXPECT_EQ(check_recording(recording).command.clipped, 0u);
}

TEST(SamplingTest, TellsGapsFromJitter) {
  std::vector<double> times;
  for (std::size_t i = 0; i < 1000; ++i)
    times.push_back(1e-3 * static_cast<double>(i) + (i % 2 == 0 ? 0.0 : 5e-5) +
                    (i >= 300 ? 4e-3 : 0.0) + (i >= 700 ? 9e-3 : 0.0));
  const Sampling found = sampling(times);
  EXPECT_EQ(found.samples, 1000u);
  EXPECT_NEAR(found.interval, 1e-3, 1.1e-4);
  EXPECT_EQ(found.gaps, 2u);
  EXPECT_NEAR(found.largest_gap, 1e-2 - 5e-5, 1e-9);
  EXPECT_EQ(found.gap_at, times[699]);
  EXPECT_GT(found.jitter, 0.04);
  EXPECT_LT(found.jitter, 0.15);
  EXPECT_EQ(sampling(moving().times).gaps, 0u);
  EXPECT_LT(sampling(moving().times).jitter, 1e-9);
}

TEST(SuggestedObserverGainTest, ShowsAHundredthOfTheAccelerationAboveTheNoise) {
  const Recording recording = moving();
  const auto &position = recording.measurements[0].values,
             &velocity = recording.measurements[1].values;
  // An acceleration of 0.1 kRate^2 / sqrt(2), noise of 1e-5 m and 2e-3 m/s.
  const double missing = 0.01 * 0.1 * kRate * kRate / std::sqrt(2.0);
  EXPECT_NEAR(suggested_observer_gain(recording.times, position, {}, {}, 0.0).rate,
              std::sqrt(missing / 1e-4), 1.0);
  // The loosest: ten times in two seconds.
  EXPECT_NEAR(missing / 2e-2, 2.4, 0.1);
  EXPECT_NEAR(suggested_observer_gain(recording.times, {}, velocity, {}, 0.0).rate, 10.0 / 2.0,
              0.1);
  // The firmest: with next to no noise all shows.
  std::mt19937_64 generator(1);
  std::normal_distribution<double> noise(0.0, 4e-8);
  std::vector<double> clean;
  for (const double t : recording.times)
    clean.push_back(0.1 * std::sin(kRate * t) + noise(generator));
  EXPECT_NEAR(suggested_observer_gain(recording.times, clean, {}, {}, 0.0).rate, 0.3 / kInterval,
              1e-6);
  // A noisy command biases the estimates the more, the higher the gain.
  std::vector<double> command;
  for (const double t : recording.times)
    command.push_back(std::sin(kRate * t) + 0.1 * std::sqrt(0.5) * noise(generator) / 4e-8);
  const double duration = recording.times.back() - recording.times.front();
  const double biased = 0.25 / (0.1 * std::sqrt(kInterval * duration));
  EXPECT_NEAR(suggested_observer_gain(recording.times, clean, {}, command, 0.0).rate, biased,
              0.1 * biased);
}

TEST(SuggestedObserverGainTest, IsNoLowerThanThatOfAKalmanFilter) {
  const Recording recording = moving();
  const auto &position = recording.measurements[0].values,
             &velocity = recording.measurements[1].values;
  std::mt19937_64 generator(1);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<double> command;
  for (const double t : recording.times) command.push_back(std::sin(kRate * t) + noise(generator));
  // Noise of 0.01 in the command moves this mass by 100 m/s^2; that of the readings is 1e-5 m and
  // 2e-3 m/s. At 1.4 % of the command it is too small to bias a mass.
  const SuggestedGain found = suggested_observer_gain(recording.times, position, {}, command, 1e-4);
  EXPECT_TRUE(found.is_of_noise);
  EXPECT_NEAR(found.rate, std::min(0.3 / kInterval, std::sqrt(100.0 / 1e-5)), 0.1 * found.rate);
  const SuggestedGain light = suggested_observer_gain(recording.times, position, {}, command, 0.1);
  EXPECT_TRUE(light.is_of_noise);
  EXPECT_NEAR(light.rate, std::sqrt(0.1 / 1e-5), 0.1 * light.rate);
  const SuggestedGain of_velocity =
      suggested_observer_gain(recording.times, {}, velocity, command, 0.1);
  EXPECT_NEAR(of_velocity.rate, 0.1 / 2e-3, 0.1 * of_velocity.rate);
  // Little noise moves a heavy mass hardly.
  EXPECT_FALSE(suggested_observer_gain(recording.times, position, {}, command, 1e3).is_of_noise);
}

TEST(RateRatioTest, FindsFactorAndSignThroughNoiseAndBias) {
  const Recording recording = moving();
  for (const double factor : {1.0, 1000.0, -1.0 / 9.80665}) {
    std::vector<double> rate = recording.find(Signal::acceleration)->values;
    for (double& x : rate) x *= factor;
    const auto found = rate_ratio(recording.times, recording.find(Signal::velocity)->values, rate);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->related());
    EXPECT_NEAR(found->ratio / factor, 1.0, 0.01);
  }
}

TEST(RateRatioTest, KnowsWhatHasNothingToDoWithIt) {
  const Recording recording = moving();
  const std::vector<double>& position = recording.find(Signal::position)->values;
  // A position is no rate of itself: a quarter of a period off.
  const auto none = rate_ratio(recording.times, position, position);
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->related());
  const std::vector<double> constant(kSamples, 0.0);
  EXPECT_FALSE(rate_ratio(recording.times, position, constant));
  EXPECT_FALSE(rate_ratio(recording.times, constant, position));
}

TEST(RecordingCheckTest, ASoundRecordingHasNothingWrong) {
  const RecordingCheck check = check_recording(moving());
  ASSERT_EQ(check.measurements.size(), 3u);
  for (const ValueCheck& values : check.measurements) {
    EXPECT_EQ(values.stuck, 0u);
    EXPECT_EQ(values.clipped, 0u);
    EXPECT_EQ(values.resolution, 0.0);
  }
  EXPECT_NEAR(check.measurements[1].noise, 2e-3, 2e-4);
  EXPECT_NEAR(check.measurements[0].high, 0.1, 1e-4);
  ASSERT_EQ(check.rates.size(), 2u);
  EXPECT_NEAR(check.rates[0].found.ratio, 1.0, 0.01);
  EXPECT_NEAR(check.rates[1].found.ratio, 1.0, 0.01);
  EXPECT_EQ(check.switches, 2u);
  EXPECT_EQ(check.command.low, -3.0);
  EXPECT_EQ(check.command.high, 2.0);
  EXPECT_NEAR(check.at_maximum, 0.25, 1e-3);  // 0.5 s of 2 s at -3 V
  EXPECT_NEAR(check.speed, 0.1 * kRate, 0.02);
}

TEST(RecordingCheckTest, FindsASensorThatHangs) {
  Recording recording = moving();
  std::vector<double>& velocity = recording.measurements[1].values.edit();
  for (std::size_t i = 1100; i < 1160; ++i) velocity[i] = velocity[1100];
  const ValueCheck check = check_recording(recording).measurements[1];
  EXPECT_EQ(check.stuck, 60u);
  EXPECT_EQ(check.stuck_at, recording.times[1100]);
  EXPECT_EQ(check.clipped, 0u);
}

TEST(RecordingCheckTest, FindsAFilterAndAHoldThatAreNotDeclared) {
  Recording recording = moving();
  Measurement& velocity = recording.measurements[1];
  Measurement& acceleration = recording.measurements[2];
  Filter filter;
  filter.kind = Filter::Kind::moving_average;
  filter.length = 21;
  velocity.values = filtered(filter, std::vector<double>(velocity.values));
  for (std::size_t i = 0; i < kSamples; ++i)
    acceleration.values.edit()[i] = acceleration.values[i - i % 4];
  RecordingCheck check = check_recording(recording);
  ASSERT_TRUE(check.measurements[1].filter);
  EXPECT_EQ(check.measurements[1].filter->average, 21u);
  EXPECT_EQ(check.measurements[2].repetition, 4u);
  EXPECT_FALSE(check.measurements[2].filter);

  velocity.filter = filter;
  acceleration.hold = 4;
  exclude_uninformative(velocity);
  exclude_uninformative(acceleration);
  check = check_recording(recording);
  for (const ValueCheck& values : check.measurements) {
    EXPECT_FALSE(values.filter);
    EXPECT_EQ(values.repetition, 1u);
  }
}

TEST(RecordingCheckTest, FindsFramesOfEverySignalAndOfTheInput) {
  // A ramp: the steps of the velocity and of the command are all alike.
  Recording recording;
  Measurement position, velocity;
  position.signal = Signal::position;
  velocity.signal = Signal::velocity;
  recording.command.hold = Hold::linear;
  for (std::size_t i = 0; i < 800; ++i) {
    const double t = 5e-3 * static_cast<double>(i), fresh = 5e-3 * static_cast<double>(i - i % 4);
    recording.times.edit().push_back(t);
    position.values.edit().push_back(fresh * fresh);
    velocity.values.edit().push_back(2.0 * fresh);
    if (i % 4 == 0) recording.command.append(t, 3.0 * fresh);
  }
  position.sigma = velocity.sigma = 1e-6;
  recording.measurements = {velocity, position};
  const RecordingCheck check = check_recording(recording);
  EXPECT_EQ(check.measurements[0].repetition, 4u);
  EXPECT_EQ(check.measurements[1].repetition, 4u);
  EXPECT_EQ(check.command.repetition, 4u);
}

TEST(RecordingCheckTest, FindsASensorOutOfItsRange) {
  Recording recording = moving();
  for (double& a : recording.measurements[2].values.edit()) a = std::min(a, 15.0);
  const ValueCheck check = check_recording(recording).measurements[2];
  EXPECT_GT(check.clipped, 100u);
  EXPECT_EQ(check.clipped_at, 15.0);
}

TEST(RecordingCheckTest, ARestIsNeitherHangingNorClipped) {
  Recording recording = moving();
  for (std::size_t i = 1500; i < kSamples; ++i)
    for (Measurement& m : recording.measurements)
      m.values.edit()[i] =
          m.signal == Signal::position ? recording.measurements[0].values[1499] : 0.0;
  for (const ValueCheck& values : check_recording(recording).measurements) {
    EXPECT_EQ(values.stuck, 0u);
    EXPECT_EQ(values.clipped, 0u);
  }
}

}  // namespace
}  // namespace axisfit
