#include "fit/judge/missing_force.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// The slide in a motion with long strokes either way, by somebody who knows of no dry friction.
Job undeclared_friction(double friction, Signal signal, std::uint64_t seed = 1) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = friction;
  Job job;
  job.model = slide();
  job.recordings = {recorded(truth, LevelsMotion{{6, -6, -6, 6, 6, -6}, 0.4}, 2.4, seed, {signal})};
  return job;
}

/// Mean of the missing force over the samples that move that way, away from reversals.
double mean_force(const MissingForce& missing, double direction) {
  double sum = 0.0, n = 0.0;
  for (std::size_t i = 50; i + 50 < missing.force.size(); ++i) {
    if (direction * missing.samples[i].velocity < 0.8) continue;
    sum += missing.force[i];
    n += 1.0;
  }
  EXPECT_GT(n, 100.0);
  return sum / n;
}

TEST(MissingForce, OfUndeclaredFrictionOpposesTheMotion) {
  for (const Signal signal : {Signal::velocity, Signal::position}) {
    SCOPED_TRACE(info(signal).name);
    const Job job = undeclared_friction(25.0, signal);
    const MissingForce missing = missing_force(job, result_at_start(job), 0);
    ASSERT_TRUE(missing.found);
    ASSERT_EQ(missing.force.size(), job.recordings[0].times.size());
    std::cout << info(signal).name << ": cutoff " << missing.cutoff << " Hz, noise "
              << missing.noise << " N, forward " << mean_force(missing, 1.0) << " N, backward "
              << mean_force(missing, -1.0) << " N\n";
    EXPECT_NEAR(mean_force(missing, 1.0), -25.0, 1.0);
    EXPECT_NEAR(mean_force(missing, -1.0), 25.0, 1.0);
    EXPECT_NEAR(missing.drive_rms, 240.0, 12.0);
  }
}

TEST(MissingForce, OfACleanRecordingIsItsNoise) {
  for (const Signal signal : {Signal::velocity, Signal::position}) {
    SCOPED_TRACE(info(signal).name);
    constexpr std::uint64_t kSeeds = 8;
    double square = 0.0, noise = 0.0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const Job job = undeclared_friction(0.0, signal, seed);
      const MissingForce missing = missing_force(job, result_at_start(job), 0);
      ASSERT_TRUE(missing.found);
      square += missing.rms * missing.rms / kSeeds;
      noise = missing.noise;
    }
    std::cout << info(signal).name << ": noise " << noise << " N, found " << std::sqrt(square)
              << " N\n";
    EXPECT_NEAR(std::sqrt(square), noise, 0.1 * noise);
  }
}

// With the paper's gear the mass that the observer moves is that of the arm alone. While the motor
// is not at its limit, the velocity loop takes on a part of the force that is missing.
TEST(MissingForce, SeesTheArmThroughTheGear) {
  Model<double> truth = paper_axis();
  add_effect<CoulombFriction>(truth).F_c = 25.0;
  Job job;
  job.model = paper_axis();
  job.recordings = {recorded(truth, LevelsMotion{{8, -8, 8}, 0.6}, 1.8, 1)};
  const MissingForce missing = missing_force(job, result_at_start(job), 0);
  ASSERT_TRUE(missing.found);
  double forward = 0.0, backward = 0.0, n_forward = 0.0, n_backward = 0.0;
  for (std::size_t i = 100; i + 100 < missing.force.size(); ++i) {
    const double v = missing.samples[i].velocity;
    (v > 0.2 ? forward : backward) += std::abs(v) > 0.2 ? missing.force[i] : 0.0;
    (v > 0.2 ? n_forward : n_backward) += std::abs(v) > 0.2 ? 1.0 : 0.0;
  }
  std::cout << "cutoff " << missing.cutoff << " Hz, forward " << forward / n_forward
            << " N, backward " << backward / n_backward << " N\n";
  EXPECT_NEAR(forward / n_forward, -25.0, 4.0);
  EXPECT_NEAR(backward / n_backward, 25.0, 4.0);
}

TEST(MissingForce, NeedsAVelocityOrAPosition) {
  Job job;
  job.model = slide();
  job.recordings = {recorded(job.model, fit_motion(), 1.2, 1, {Signal::acceleration})};
  EXPECT_FALSE(missing_force(job, result_at_start(job), 0).found);
}

TEST(PercentOfDrive, IsWhatNoiseDoesNotExplain) {
  MissingForce force;
  force.found = true;
  force.rms = 5.0;
  force.noise = 3.0;
  force.drive_rms = 20.0;
  EXPECT_EQ(percent_of_drive(force), 0.0) << "hardly more than noise";
  force.noise = 2.5;
  EXPECT_DOUBLE_EQ(percent_of_drive(force), 100.0 * std::sqrt(25.0 - 6.25) / 20.0);
  force.noise = 0.0;
  EXPECT_DOUBLE_EQ(percent_of_drive(force), 25.0);
  force.found = false;
  EXPECT_EQ(percent_of_drive(force), 0.0);
}

// Noise of the signal is that of the force: the more of it, the lower the frequencies that are
// left.
TEST(MissingForce, OfANoisySignalIsSlower) {
  Job job = undeclared_friction(25.0, Signal::velocity);
  const double sharp = missing_force(job, result_at_start(job), 0).cutoff;
  job.recordings[0].measurements[0].sigma *= 20.0;
  const MissingForce slow = missing_force(job, result_at_start(job), 0);
  EXPECT_LT(slow.cutoff, sharp);
  EXPECT_GE(slow.cutoff, 5.0);
  EXPECT_LE(sharp, 40.0);
  job.recordings[0].measurements[0].sigma *= 1e4;
  EXPECT_EQ(missing_force(job, result_at_start(job), 0).cutoff, 5.0);
}

}  // namespace
}  // namespace axisfit
