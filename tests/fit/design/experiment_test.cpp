#include "fit/design/experiment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// Somebody has recorded only a slow motion of a slide, which hardly shows its mass.
Job slow_job(std::uint64_t seed) {
  Job job;
  job.model = slide();
  job.options.threads = 2;
  job.free = {free_parameter("M", 20.0), free_parameter("B_a", 30.0)};
  job.recordings = {recorded(slide(), SineMotion{0.3, 0.5, 0.5}, 2.0, seed)};
  return job;
}

constexpr MachineLimits kLimits{-0.2, 0.6, 0.8, 10.0};

TEST(SuggestExperiment, IsFollowedWithTheSuccessPredicted) {
  Job job = slow_job(5);
  job.limits = kLimits;
  const FitResult before = estimate(job);
  ASSERT_TRUE(before.is_usable());
  const auto suggestion = suggest_experiment(job, before);
  ASSERT_TRUE(suggestion);
  const auto relative = [&](const Uncertainty& u, std::size_t i) {
    return u.parameters[i].standard_error / before.parameters[i].value;
  };
  const std::size_t worst = suggestion->parameter;
  const auto now = [&](std::size_t i) {
    return before.parameters[i].uncertainty.standard_error / before.parameters[i].value;
  };
  EXPECT_GT(now(worst), now(1 - worst));
  EXPECT_LT(relative(suggestion->predicted, worst), 0.5 * now(worst));

  job.recordings.push_back(
      recorded(slide(), suggestion->experiment.motion, suggestion->experiment.duration, 6));
  job.recordings.back().name = "next";
  const FitResult after = estimate(job);
  ASSERT_TRUE(after.is_usable());
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const double predicted = suggestion->predicted.parameters[i].standard_error;
    EXPECT_NEAR(after.parameters[i].uncertainty.standard_error, predicted, 0.15 * predicted);
  }
  // And the machine stayed within its limits.
  for (const Sample& s : after.recordings.back().free_running.samples) {
    EXPECT_GE(s.position, *kLimits.lowest - 1e-3);
    EXPECT_LE(s.position, *kLimits.highest + 1e-3);
    EXPECT_LE(std::abs(s.velocity), *kLimits.speed + 1e-3);
    EXPECT_LE(std::abs(s.command), *kLimits.command);
  }
}

TEST(SuggestExperiment, KeepsToWhatTheRecordingsCovered) {
  const Job job = slow_job(7);
  const FitResult fit = estimate(job);
  const auto suggestion = suggest_experiment(job, fit);
  ASSERT_TRUE(suggestion);
  EXPECT_GT(suggestion->tried, 200);
  EXPECT_LT(suggestion->feasible, suggestion->tried);
  double highest = 0.0;
  for (const Sample& s : fit.recordings[0].free_running.samples)
    highest = std::max(highest, s.position);
  EXPECT_DOUBLE_EQ(*suggestion->limits.highest, highest);
}

// Motions that are safe at the estimates, but not for all that the fit leaves open, are not.
TEST(SuggestExperiment, IsSafeForWhateverTheParametersMayBe) {
  Job job = slow_job(5);
  job.limits = kLimits;
  FitResult fit = estimate(job);
  const auto sure = suggest_experiment(job, fit);
  ASSERT_TRUE(sure);
  // The friction is a tenth of what the fit says: with the same force the slide goes ten times as
  // far.
  ParameterUncertainty& friction = fit.parameters[1].uncertainty;
  friction.lower = 0.1 * fit.parameters[1].value;
  EXPECT_FALSE(reach_of(sure->experiment, job, fit, kLimits));
  const auto careful = suggest_experiment(job, fit);
  ASSERT_TRUE(careful);
  Job slippery = job;
  slippery.model.axis.B_a = 3.0;
  slippery.free.resize(1);
  slippery.recordings = {
      recorded(slippery.model, careful->experiment.motion, careful->experiment.duration, 6)};
  const auto [lowest, highest, speed] = careful->reach;
  const FitResult truly = result_at_start(slippery);
  for (const Sample& s : truly.recordings[0].free_running.samples) {
    EXPECT_GE(s.position, lowest - 1e-3);
    EXPECT_LE(s.position, highest + 1e-3);
    EXPECT_LE(std::abs(s.velocity), speed + 1e-3);
  }
  EXPECT_GE(lowest, *kLimits.lowest - 1e-6);
  EXPECT_LE(highest, *kLimits.highest + 1e-6);
  EXPECT_LE(speed, *kLimits.speed + 1e-6);
}

// At a bound, and with no interval, any value that the bounds allow may be the true one.
TEST(SuggestExperiment, TrustsNoParameterAtItsBound) {
  Job job = slow_job(5);
  job.limits = kLimits;
  FitResult fit = estimate(job);
  fit.parameters[1].value = job.free[1].upper = 1e4;
  fit.parameters[1].uncertainty = {.at_bound = true};
  for (const double u : {0.5, 1.0, 5.0, 10.0})
    EXPECT_FALSE(reach_of({StepMotion{u, 0.0}, 2.5}, job, fit, {-0.05, 0.05, 0.1, 10.0})) << u;
  // What lies beyond a bound that the user chose, no simulation shows.
  EXPECT_EQ(held_by_bound(job, fit), 1u);
  EXPECT_FALSE(suggest_experiment(job, fit));
  // Beyond the end of a quantity's range there is nothing.
  fit.parameters[1].value = job.free[1].upper =
      quantity_list()[job.free[1].quantity].quantity.upper;
  EXPECT_FALSE(held_by_bound(job, fit));
}

// A search for effects leaves a job with other initial values than those that it was solved from.
TEST(SuggestExperiment, DoesNotDependOnWhereTheFitStarted) {
  Job job = slow_job(5);
  job.limits = kLimits;
  FreeParameter& mass = job.free[0];
  mass.scale = Scale::linear;
  const FitResult fit = estimate(job);
  const auto expected = suggest_experiment(job, fit);
  mass.initial *= 3.0;
  const auto found = suggest_experiment(job, fit);
  ASSERT_TRUE(expected && found);
  for (std::size_t i = 0; i < 2; ++i) {
    const double error = expected->predicted.parameters[i].standard_error;
    EXPECT_NEAR(found->predicted.parameters[i].standard_error, error, 1e-6 * error);
  }
}

// What is not determined may be anything within its bounds. A motion that is safe then may show it.
TEST(SuggestExperiment, DeterminesWhatWasNotDetermined) {
  const Model<double> truth = motor_axis();
  Job job = two_recordings(truth, truth, {"V_L", "T_p"});
  job.recordings = {recorded(truth, SineMotion{0.4, 2.0, 2.0}, 1.0, 3)};
  job.limits = {-1.0, 1.0, 1.0, 10.0};
  const FitResult fit = estimate(job);
  ASSERT_FALSE(fit.parameters[0].uncertainty.determined);
  const auto suggestion = suggest_experiment(job, fit);
  ASSERT_TRUE(suggestion);
  EXPECT_EQ(suggestion->parameter, 0u);
  EXPECT_TRUE(suggestion->predicted.parameters[0].determined);
  // With the machine's preamplifier, and with any other.
  for (const double V_L : {job.free[0].lower, truth.axis.V_L, job.free[0].upper}) {
    Job machine = job;
    machine.model.axis.V_L = V_L;
    machine.free.erase(machine.free.begin());
    machine.recordings = {
        recorded(machine.model, suggestion->experiment.motion, suggestion->experiment.duration, 6)};
    const FitResult moved = result_at_start(machine);
    for (const Sample& s : moved.recordings[0].free_running.samples)
      EXPECT_TRUE(is_within(job.limits, s.position, s.velocity)) << V_L;
  }
}

TEST(SuggestExperiment, HasNoneWhereNothingIsAllowed) {
  Job job = slow_job(7);
  job.limits = {0.0, 0.0, 1e-9, 1.0};
  EXPECT_FALSE(suggest_experiment(job, estimate(job)));
}

// Residuals are expected to be of the size that the fit has left: who states a third of the true
// noise is not promised more than who states it as it is.
TEST(SuggestExperiment, PromisesNoMoreWhereTheNoiseIsUnderstated) {
  Job job = slow_job(5);
  job.limits = kLimits;
  const FitResult stated = estimate(job);
  const auto expected = suggest_experiment(job, stated);
  for (Measurement& m : job.recordings[0].measurements) m.sigma /= 3.0;
  const FitResult hopeful = estimate(job);
  EXPECT_NEAR(hopeful.reduced_chi_square, 9.0, 0.5);
  const auto found = suggest_experiment(job, hopeful);
  ASSERT_TRUE(expected && found);
  for (std::size_t i = 0; i < 2; ++i) {
    const double now = stated.parameters[i].uncertainty.standard_error;
    EXPECT_NEAR(hopeful.parameters[i].uncertainty.standard_error, now, 0.05 * now);
    EXPECT_GT(found->predicted.parameters[i].standard_error,
              0.95 * expected->predicted.parameters[i].standard_error);
  }
}

TEST(MachineLimits, HoldEitherWay) {
  const MachineLimits limits{-0.2, 0.6, 0.8, 10.0};
  EXPECT_TRUE(is_within(limits, 0.0, 0.0));
  EXPECT_TRUE(is_within(limits, 0.6, 0.8));
  EXPECT_TRUE(is_within(limits, -0.2, -0.8));
  EXPECT_FALSE(is_within(limits, 0.0, 0.81));
  EXPECT_FALSE(is_within(limits, 0.0, -0.81));
  EXPECT_FALSE(is_within(limits, 0.61, 0.0));
  EXPECT_FALSE(is_within(limits, -0.21, 0.0));
}

}  // namespace
}  // namespace axisfit
