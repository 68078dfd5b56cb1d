#include "fit/estimate/kalman_gain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/criterion/gains.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

constexpr double kMass = 20.0, kForceConstant = 40.0;
const std::vector<double> kValues{kMass, 30.0};

Job noisy(double sigma, const std::vector<Signal>& signals) {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"}, 6.0, signals);
  add_input_noise(job, sigma);
  return job;
}

TEST(KalmanGain, IsThatOfANoisyAcceleration) {
  for (const double sigma : {0.05, 0.4}) {
    const double acceleration = sigma * kForceConstant / kMass;
    const double of_velocity = acceleration / usual_noise(Signal::velocity);
    EXPECT_NEAR(*kalman_gain(noisy(sigma, {Signal::velocity}), kValues), of_velocity,
                0.1 * of_velocity);
    const double of_position = std::sqrt(acceleration / usual_noise(Signal::position));
    EXPECT_NEAR(*kalman_gain(noisy(sigma, {Signal::position}), kValues), of_position,
                0.1 * of_position);
  }
}

TEST(KalmanGain, IsNoHigherThanTheSamplingAllows) {
  const Job job = noisy(20.0, {Signal::velocity});
  EXPECT_EQ(*kalman_gain(job, kValues), highest_gain(job));
}

TEST(KalmanGain, IsNothingWithoutNoiseOfTheInputOrASignalToTrack) {
  EXPECT_FALSE(kalman_gain(noisy(0.0, {Signal::velocity}), kValues));
  EXPECT_FALSE(kalman_gain(noisy(0.4, {Signal::acceleration}), kValues));
}

TEST(KalmanGain, IsAskedForWhereNoiseOfTheInputMovesAFreeRun) {
  Job job = noisy(0.1, {Signal::position});
  const FitResult free = estimate(job);
  const std::optional<double> gain = quiet_gain(job, free);
  ASSERT_TRUE(gain);
  EXPECT_EQ(gain, kalman_gain(job, values_of(free)));
  // A fit that tracks at it has the smaller errors.
  job.options.criterion = Tracking{*gain};
  const FitResult tracking = estimate(job);
  EXPECT_FALSE(quiet_gain(job, tracking));
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const ParameterUncertainty &of_free = free.parameters[i].uncertainty,
                               &of_tracking = tracking.parameters[i].uncertainty;
    EXPECT_LT(of_tracking.standard_error, 0.8 * of_free.standard_error);
    EXPECT_NEAR(tracking.parameters[i].value, kValues[i], 3.0 * of_tracking.standard_error);
  }
  const Job quiet = noisy(1e-3, {Signal::position});
  EXPECT_FALSE(quiet_gain(quiet, estimate(quiet)));
}

}  // namespace
}  // namespace axisfit
