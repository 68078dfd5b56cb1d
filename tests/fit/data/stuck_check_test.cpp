// clean_recordings_test.cpp has the rates of false and of true findings.
#include "fit/data/stuck_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/data/clean_recordings.h"

namespace axisfit::clean {
namespace {

constexpr std::size_t kSamples = 2000;

/// A sine of one metre in two seconds that pauses for 46 samples at each of its ends.
Course pausing() {
  Course course{1e-3};
  double phase = 0.0;
  std::size_t rests = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double x = -std::cos(phase);
    course.position.push_back(x);
    course.velocity.push_back(rests > 0 ? 0.0 : 12.6 * std::sin(phase));
    course.force.push_back(std::cos(5.0 * course.interval * static_cast<double>(i)));
    if (rests > 0) {
      --rests;
      continue;
    }
    const double before = phase;
    phase += 0.0126;
    if (std::floor(before / 3.1416) != std::floor(phase / 3.1416)) rests = 46;
  }
  return course;
}

TEST(StuckCheckTest, ARestOf46SamplesIsNone) {
  const Course course = pausing();
  const std::vector<double> counted = rounded(course.position, 1e-4);
  Recording recording = with_command(course, course.force);
  add(recording, Signal::velocity, differences(counted, course.interval));
  EXPECT_EQ(StuckCheck(recording, {}).stuck(recording.measurements[0]).size(), 0u);
  EXPECT_EQ(StuckCheck(recording, {}).clipped(recording.measurements[0]).samples, 0u);
  // Neither where the position tells of it.
  add(recording, Signal::position, counted);
  EXPECT_EQ(StuckCheck(recording, {}).stuck(recording.measurements[0]).size(), 0u);
  // A sensor that shows a rest where the position has none.
  std::vector<double>& velocity = recording.measurements[0].values.edit();
  std::fill(velocity.begin() + 600, velocity.begin() + 646, 0.0);
  const EqualValues stuck = StuckCheck(recording, {}).stuck(recording.measurements[0]);
  EXPECT_EQ(stuck.from, 600u);
  EXPECT_EQ(stuck.size(), 46u);
}

TEST(StuckCheckTest, TheTopCountOfACoarseEncoderIsNoRange) {
  Course course{1e-3};
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double phase = 5.0 * course.interval * static_cast<double>(i);
    course.position.push_back(std::sin(phase));
    course.velocity.push_back(5.0 * std::cos(phase));
    course.force.push_back(std::cos(phase));
  }
  // At most three counts between two samples.
  Recording recording = with_command(course, course.force);
  add(recording, Signal::velocity,
      differences(rounded(course.position, 5e-3 / 2.6), course.interval));
  EXPECT_EQ(StuckCheck(recording, {}).clipped(recording.measurements[0]).samples, 0u);
  // With noise, an end in the middle of the way is one.
  Dice dice(1);
  std::vector<double> clipped = noisy(course.velocity, 0.02, dice);
  for (double& v : clipped) v = std::min(v, 4.0);
  recording.measurements.clear();
  add(recording, Signal::velocity, clipped);
  const ClippedValues found = StuckCheck(recording, {}).clipped(recording.measurements[0]);
  EXPECT_EQ(found.value, 4.0);
  EXPECT_GT(found.samples, 300u);
}

TEST(SampledCommandTest, HasTheValueInForce) {
  Recording recording;
  recording.times = {0.0, 1.0, 2.0, 3.0};
  recording.command = {{0.5, 2.0}, {4.0, 5.0}};
  EXPECT_EQ(sampled_command(recording), (std::vector<double>{0.0, 4.0, 5.0, 5.0}));
}

}  // namespace
}  // namespace axisfit::clean
