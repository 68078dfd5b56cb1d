#include "fit/data/filter_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fit/data/filter.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// A smooth motion with white noise, and what a recorder made of it.
std::vector<double> motion(std::uint64_t seed, const Filter& filter = {}, std::size_t n = 2000) {
  Normal normal(seed);
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i)
    values[i] = std::sin(0.02 * static_cast<double>(i)) + 2e-3 * normal();
  return filtered(filter, std::move(values));
}

std::vector<double> rounded(std::vector<double> values, double step) {
  for (double& x : values) x = step * std::floor(x / step);
  return values;
}

Filter butterworth(int order, double cutoff, bool zero_phase) {
  return {Filter::Kind::butterworth, 1, order, cutoff, zero_phase};
}

TEST(RepetitionTest, IsFoundWithRestsAndSlips) {
  std::vector<double> values = motion(1);
  EXPECT_EQ(repetition_of(values), 1u);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = values[i - i % 10];
  std::fill(values.begin() + 500, values.begin() + 800, values[500]);
  values.erase(values.begin() + 1203, values.begin() + 1205);
  EXPECT_EQ(repetition_of(values), 10u);
}

TEST(RepetitionTest, IsNotRounding) {
  // One step every tenth sample.
  std::vector<double> values;
  for (int i = 0; i < 2000; ++i) values.push_back(1e-5 * std::floor(0.1 * i + 0.05));
  EXPECT_EQ(repetition_of(values), 1u);
  EXPECT_EQ(repetition_of(rounded(motion(2), 0.02)), 1u);
  EXPECT_EQ(repetition_of(std::vector<double>(2000, 1.0)), 1u);
}

TEST(RepetitionTest, IsSharedByWhatComesInOneMessage) {
  std::vector<double> known = motion(1), ramp;
  for (std::size_t i = 0; i < known.size(); ++i) {
    known[i] = known[i - i % 4];
    ramp.push_back(0.1 * static_cast<double>(i - i % 4));
  }
  EXPECT_EQ(repetition_of(ramp), 1u);  // as rounding would
  EXPECT_TRUE(changes_with(ramp, known));
  EXPECT_FALSE(changes_with(known, motion(2)) && changes_with(motion(2), known));
  EXPECT_FALSE(changes_with(std::vector<double>(known.size(), 1.0), known));
}

TEST(SuspectedFilterTest, IsNotWhatTheCommandDoes) {
  // A random sequence with a new value at every fifth sample that drives through a lag, with noise
  // in the command, so that it is no staircase.
  Normal normal(7);
  std::vector<double> command, values;
  double level = 0.0, state = 0.0;
  for (std::size_t i = 0; i < 4000; ++i) {
    if (i % 5 == 0) level = normal();
    command.push_back(level + 1e-3 * normal());
    state += 0.3 * (level - state);
    values.push_back(state + 1e-4 * normal());
  }
  EXPECT_TRUE(suspected_filter(values));
  EXPECT_FALSE(suspected_filter(values, command));
  EXPECT_TRUE(suspected_filter(motion(4, butterworth(2, 0.1, false), 4000), command));
}

TEST(SuspectedFilterTest, IsNoAverageOfARoundedTone) {
  for (double period = 61.7; period < 600.0; period *= 1.1) {
    std::vector<double> values(4000);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / period);
    EXPECT_FALSE(suspected_filter(rounded(values, 3e-3))) << period;
    EXPECT_FALSE(suspected_filter(values)) << period;
  }
}

TEST(SuspectedFilterTest, TellsTheLengthOfAMovingAverage) {
  for (const std::size_t length : {8u, 21u, 50u})
    for (const bool zero_phase : {false, true}) {
      const auto found =
          suspected_filter(motion(3, {Filter::Kind::moving_average, length, 1, 0.25, zero_phase}));
      ASSERT_TRUE(found) << length;
      EXPECT_EQ(found->average, length);
    }
}

TEST(SuspectedFilterTest, TellsTheCornerOfAButterworthFilter) {
  for (const int order : {1, 2, 3, 4})
    for (const double cutoff : {0.05, 0.1, 0.2})
      for (const bool zero_phase : {false, true}) {
        const auto found = suspected_filter(motion(4, butterworth(order, cutoff, zero_phase)));
        ASSERT_TRUE(found) << order << ' ' << cutoff << ' ' << zero_phase;
        EXPECT_EQ(found->average, 0u);
        EXPECT_LT(std::abs(std::log2(found->corner / cutoff)), 1.5)
            << order << ' ' << cutoff << ' ' << zero_phase;
      }
}

TEST(SuspectedFilterTest, IsNotThereInFewValues) {
  EXPECT_FALSE(suspected_filter(motion(3, butterworth(2, 0.1, false), 499)));
}

// Of 1200 signals no more than 6; here none of them.
TEST(SuspectedFilterTest, IsNotSeenInWhiteNoiseOrRounding) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const std::vector<double> values = motion(seed);
    for (const std::vector<double>& v :
         {values, rounded(values, 1e-3), rounded(values, 4e-3), rounded(values, 2e-2)})
      found += suspected_filter(v).has_value();
  }
  EXPECT_EQ(found, 0);
}

// An axis whose gear rings and whose command jumps, at several speeds.
TEST(SuspectedFilterTest, IsNotSeenInAnAxis) {
  int found = 0;
  const std::vector<Signal> signals{Signal::position, Signal::velocity, Signal::acceleration,
                                    Signal::tachometer, Signal::motor_current};
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const double volts = 2.0 + 0.6 * static_cast<double>(seed);
    const Recording recording = recorded(paper_axis(), fit_motion(volts), 1.2, seed, signals);
    for (const Measurement& m : recording.measurements) {
      const auto suspected = suspected_filter(m.values);
      found += suspected.has_value();
      EXPECT_FALSE(suspected) << info(m.signal).name << " at " << volts << " V";
    }
  }
  EXPECT_EQ(found, 0);
}

TEST(SuspectedFilterTest, IsNotSeenInATone) {
  for (double frequency = 0.01; frequency < 0.5; frequency *= 1.1) {
    std::vector<double> values = motion(5);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] += 0.05 * std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(i));
    EXPECT_FALSE(suspected_filter(values)) << frequency;
  }
}

}  // namespace
}  // namespace axisfit
