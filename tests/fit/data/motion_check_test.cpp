#include "fit/data/motion_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/data/stuck_check.h"
#include "tests/fit/data/clean_recordings.h"

namespace axisfit::clean {
namespace {

Recording by_encoder(const Course& course, const std::vector<double>& command, double steps) {
  Recording recording = with_command(course, command);
  add(recording, Signal::position, rounded(course.position, size_of(course.position) / steps));
  return recording;
}

// 195 of 199; the others are slow beside the steps of their encoder.
TEST(HardStopTest, IsFoundWithinThreeSamples) {
  int found = 0, of = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Dice dice(7000 + seed);
    Plant plant;
    plant.viscous = dice.logarithmic(0.2, 5.0);
    plant.coulomb = plant.breakaway = dice.uniform(0.05, 0.3);
    plant.stop = dice.uniform(0.3, 0.9);
    const double push = dice.uniform(0.8, 4.0), start = dice.uniform(0.1, 0.5);
    const double interval = 1.0 / dice.logarithmic(100.0, 5000.0);
    const auto samples = static_cast<std::size_t>(6.0 / interval);
    const Course course = moved(plant, interval, samples,
                                [&](double t, double, double) { return t < start ? -0.2 : push; });
    const auto hit = static_cast<std::size_t>(
        std::ranges::find_if(course.position, [&](double x) { return x >= plant.stop; }) -
        course.position.begin());
    if (hit + 40 > samples) continue;
    ++of;
    Recording recording = by_encoder(course, course.force, dice.logarithmic(300.0, 1e5));
    if (seed % 2 == 0) {
      recording.measurements.clear();
      add(recording, Signal::velocity,
          noisy(course.velocity, 0.01 * size_of(course.velocity), dice));
    }
    const auto stop = hard_stop(recording, sampled_command(recording));
    if (!stop) continue;
    ++found;
    EXPECT_LE(std::abs(stop->at - recording.times[hit]), 3.1 * interval) << seed;
    EXPECT_LT(stop->last_before, recording.times[hit]) << seed;
  }
  EXPECT_GT(of, 190);
  EXPECT_GT(found, 185) << "of " << of;  // three standard errors below
}

TEST(HardStopTest, IsNotARest) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Clean clean = clean_recording(seed);
    EXPECT_FALSE(hard_stop(clean.recording, sampled_command(clean.recording))) << clean.name;
  }
  // Nor is it one where the drive let go, or where the arm leaves it again.
  Plant plant;
  plant.stop = 0.5;
  for (const double behind : {0.0, -2.0}) {
    const Course course = moved(plant, 1e-3, 3000, [&](double t, double x, double) {
      return x < plant.stop && t < 2.0 ? 2.0 : behind;
    });
    const Recording recording = by_encoder(course, course.force, 2000.0);
    EXPECT_FALSE(hard_stop(recording, sampled_command(recording))) << behind;
  }
}

TEST(MagnitudeTest, IsACommandThatNeverIsNegativeWhereTheAxisGoesBothWays) {
  Plant plant;
  plant.viscous = 3.0;
  const Course course = moved(plant, 1e-3, 6000, [](double t, double, double) {
    return 3.0 * std::sin(4.0 * t) + std::sin(1.7 * t);
  });
  std::vector<double> size = course.force;
  for (double& u : size) u = std::abs(u);
  Recording recording = by_encoder(course, size, 2000.0);
  EXPECT_TRUE(is_magnitude(recording, sampled_command(recording)));
  for (double& u : size) u = -u;
  recording = by_encoder(course, size, 2000.0);
  EXPECT_TRUE(is_magnitude(recording, sampled_command(recording)));
  recording = by_encoder(course, course.force, 2000.0);
  EXPECT_FALSE(is_magnitude(recording, sampled_command(recording)));
}

TEST(MagnitudeTest, IsASpeedWithoutItsSign) {
  Plant plant;
  plant.viscous = 50.0;  // it follows at once
  const Course course =
      moved(plant, 1e-3, 6000, [](double t, double, double) { return 30.0 * std::sin(2.0 * t); });
  std::vector<double> size = course.force;
  for (double& u : size) u = std::abs(u);
  const Recording recording = by_encoder(course, size, 2000.0);
  EXPECT_TRUE(is_magnitude(recording, sampled_command(recording)));
}

// A weight or a pendulum comes back by itself.
TEST(MagnitudeTest, IsNotAPushAgainstAWeight) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Dice dice(9000 + seed);
    Plant plant;
    plant.viscous = dice.logarithmic(0.2, 5.0);
    plant.coulomb = plant.breakaway = dice.uniform(0.05, 1.0);
    const double weight = dice.uniform(1.0, 4.0), rate = dice.uniform(0.5, 5.0);
    (seed % 2 == 0 ? plant.weight : plant.swing) = weight;
    const Course course = moved(plant, 1e-3, 8000, [&](double t, double x, double v) {
      if (seed % 4 == 1) return std::fmod(t, 2.0) < 1.0 ? weight : 0.0;
      if (seed % 4 == 3) return std::max(0.0, 1.5 * weight * std::sin(rate * t));
      return std::max(0.0, weight + 40.0 * (0.3 * std::sin(rate * t) - x) - 5.0 * v);
    });
    const Recording recording = by_encoder(course, course.force, 2000.0);
    EXPECT_FALSE(is_magnitude(recording, sampled_command(recording))) << seed;
  }
}

}  // namespace
}  // namespace axisfit::clean
