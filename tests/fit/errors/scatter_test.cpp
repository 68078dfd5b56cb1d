// Parameters that differ from recording to recording.
#include "fit/errors/scatter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/estimate/estimate.h"
#include "tests/fit/scattering.h"

namespace axisfit {
namespace {

std::optional<Scatter> scatter_in(const Job& job, const FitResult& fit) {
  return scatter_of(job, fit.parameters, fit.observer_gain);
}

/// What is known of a parameter, of which all are of the machine, with its scatter.
ParameterUncertainty with_scatter(const Job& job, const FitResult& fit, const Scatter& scatter,
                                  std::size_t parameter) {
  const ParameterResult& p = fit.parameters[parameter];
  ErrorBudget budget = p.budget;
  budget.scatter = scatter.parameters[parameter].error;
  return combined(budget, p.value, job.free[parameter]);
}

TEST(Scatter, IsEstimatedAndWidensWhatScatters) {
  constexpr int kMachines = 12;
  double sum = 0.0;
  int held = 0, held_deviation = 0;
  for (std::uint64_t seed = 1; seed <= kMachines; ++seed) {
    const Job job = scattering_machine(8, 0.05, seed);
    const FitResult fit = estimate(job);
    const auto scatter = scatter_in(job, fit);
    ASSERT_TRUE(scatter);
    EXPECT_FALSE(scatter->of_stretches);
    EXPECT_EQ(scatter->fitted_groups(), 8u);
    ASSERT_EQ(scatter->parameters.size(), 2u);
    EXPECT_EQ(scatter->parameters[0].error.has_value(), scatter->parameters[0].deviation > 0.0);
    const ParameterScatter& damping = scatter->parameters[1];
    sum += damping.deviation / kMachines;
    held_deviation +=
        damping.lower < 0.05 * kScatteringDamping && damping.upper > 0.05 * kScatteringDamping;
    EXPECT_LE(damping.within, fit.parameters[1].uncertainty.standard_error);
    // The mean of eight.
    const ParameterUncertainty known = with_scatter(job, fit, *scatter, 1);
    EXPECT_NEAR(known.standard_error, damping.deviation / std::sqrt(8.0),
                0.2 * known.standard_error);
    held += known.lower < kScatteringDamping && known.upper > kScatteringDamping;
    // 2.36 standard errors of seven degrees of freedom, not 1.96.
    EXPECT_GT(known.upper - known.lower, 2.0 * 2.2 * known.standard_error);
  }
  EXPECT_NEAR(sum, 0.05 * kScatteringDamping, 0.2 * 0.05 * kScatteringDamping);
  EXPECT_GE(held, 10);
  EXPECT_GE(held_deviation, 10);
}

// The residual of the whole fit has the scatter in it, which that of each recording has not.
TEST(Scatter, InsideRecordingsTheErrorIsThatOfAMachineThatHasNone) {
  const Job job = scattering_machine(8, 0.05, 3);
  const auto scatter = scatter_in(job, estimate(job));
  ASSERT_TRUE(scatter);
  ASSERT_TRUE(scatter->parameters[1].error);
  const double without =
      estimate(scattering_machine(8, 0.0, 3)).parameters[1].uncertainty.standard_error;
  EXPECT_NEAR(scatter->parameters[1].error->inside, without, 0.2 * without);
}

TEST(Scatter, ChangesNothingWhereThereIsNone) {
  int changed = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Job job = scattering_machine(4, 0.0, seed, 1.0);
    const FitResult fit = estimate(job);
    const auto scatter = scatter_in(job, fit);
    ASSERT_TRUE(scatter);
    for (std::size_t i = 0; i < 2; ++i)
      changed += with_scatter(job, fit, *scatter, i).standard_error !=
                 fit.parameters[i].uncertainty.standard_error;
  }
  EXPECT_LE(changed, 6);  // of 16, at a significance of 20 %
}

// The estimates of the recordings alone are those that fits of them alone find, but for the square
// of how far they are apart: 5 %.
TEST(Scatter, TellsWhatEachRecordingSays) {
  const Job job = scattering_machine(3, 0.05, 4);
  const FitResult fit = estimate(job);
  const auto scatter = scatter_in(job, fit);
  ASSERT_TRUE(scatter);
  for (std::size_t r = 0; r < 3; ++r) {
    Job alone = job;
    alone.recordings = {job.recordings[r]};
    const FitResult found = estimate(alone);
    for (std::size_t i = 0; i < 2; ++i) {
      const EstimateOfGroup& group = scatter->parameters[i].groups[r];
      EXPECT_TRUE(group.determined);
      EXPECT_NEAR(group.value, found.parameters[i].value, 0.05 * 0.05 * group.value);
      EXPECT_NEAR(group.standard_error, found.parameters[i].uncertainty.standard_error,
                  0.2 * group.standard_error);
    }
  }
}

TEST(Scatter, AddsToWhatAnotherObserverGainMakesOfAnEstimate) {
  const Job job = scattering_machine(6, 0.05, 3);
  FitResult fit = estimate(job);
  const auto scatter = scatter_in(job, fit);
  ASSERT_TRUE(scatter);
  ASSERT_GT(scatter->parameters[1].deviation, 0.0);
  const double plain = with_scatter(job, fit, *scatter, 1).standard_error;
  ParameterResult& p = fit.parameters[1];
  const double move = 3.0 * p.uncertainty.standard_error;
  p.budget.gain = GainShift{1.0, p.value + move};
  const auto moved = scatter_in(job, fit);
  ASSERT_TRUE(moved);
  EXPECT_NEAR(with_scatter(job, fit, *moved, 1).standard_error, std::hypot(plain, move),
              1e-9 * p.value);
  EXPECT_NEAR(moved->parameters[1].within, std::hypot(scatter->parameters[1].within, move),
              1e-9 * p.value);
}

TEST(Scatter, OfRecordingsToValidateIsShownOnly) {
  Job job = scattering_machine(3, 0.0, 5);
  job.recordings[2].role = Role::validate;
  const FitResult fit = estimate(job);
  const auto scatter = scatter_in(job, fit);
  ASSERT_TRUE(scatter);
  EXPECT_EQ(scatter->groups.size(), 3u);
  EXPECT_EQ(scatter->fitted_groups(), 2u);
  EXPECT_FALSE(scatter->groups[2].fitted);
}

TEST(Scatter, OfOneRecordingIsThatOfItsStretches) {
  Job job = scattering_machine(1, 0.0, 6, 6.0);
  const FitResult fit = estimate(job);
  const auto scatter = scatter_in(job, fit);
  ASSERT_TRUE(scatter);
  EXPECT_TRUE(scatter->of_stretches);
  EXPECT_EQ(scatter->fitted_groups(), 6u);
  // What happens in a stretch of a free-running simulation depends on those before.
  job.options.criterion = FreeRun{};
  job.options.continuation.reset();
  EXPECT_FALSE(scatter_in(job, estimate(job)));
}

}  // namespace
}  // namespace axisfit
