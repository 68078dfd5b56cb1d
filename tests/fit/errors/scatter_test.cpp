// Parameters that differ from recording to recording.
#include "fit/errors/scatter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/errors/gain_sensitivity.h"
#include "tests/fit/scattering.h"

namespace axisfit {
namespace {

TEST(Scatter, IsEstimatedAndWidensWhatScatters) {
  constexpr int kMachines = 12;
  double sum = 0.0;
  int held = 0, held_deviation = 0;
  for (std::uint64_t seed = 1; seed <= kMachines; ++seed) {
    const Job job = scattering_machine(8, 0.05, seed);
    FitResult fit = estimate(job);
    const double mass_before = fit.parameters[0].uncertainty.standard_error,
                 damping_before = fit.parameters[1].uncertainty.standard_error;
    const auto scatter = allow_for_scatter(job, fit);
    ASSERT_TRUE(scatter);
    EXPECT_FALSE(scatter->of_stretches);
    EXPECT_EQ(scatter->fitted_groups(), 8u);
    ASSERT_EQ(scatter->parameters.size(), 2u);
    if (scatter->parameters[0].deviation == 0.0) {
      EXPECT_EQ(fit.parameters[0].uncertainty.standard_error, mass_before);
    }
    const ParameterScatter& damping = scatter->parameters[1];
    sum += damping.deviation / kMachines;
    held_deviation +=
        damping.lower < 0.05 * kScatteringDamping && damping.upper > 0.05 * kScatteringDamping;
    EXPECT_LE(damping.within, damping_before);
    // The mean of eight.
    const ParameterUncertainty& known = fit.parameters[1].uncertainty;
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

TEST(Scatter, ChangesNothingWhereThereIsNone) {
  int changed = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Job job = scattering_machine(4, 0.0, seed, 1.0);
    FitResult fit = estimate(job);
    const FitResult before = fit;
    const auto scatter = allow_for_scatter(job, fit);
    ASSERT_TRUE(scatter);
    for (std::size_t i = 0; i < 2; ++i)
      changed += fit.parameters[i].uncertainty.standard_error !=
                 before.parameters[i].uncertainty.standard_error;
  }
  EXPECT_LE(changed, 6);  // of 16, at a significance of 20 %
}

// The estimates of the recordings alone are those that fits of them alone find, but for the square
// of how far they are apart: 5 %.
TEST(Scatter, TellsWhatEachRecordingSays) {
  const Job job = scattering_machine(3, 0.05, 4);
  FitResult fit = estimate(job);
  const auto scatter = allow_for_scatter(job, fit);
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
  FitResult plain = estimate(job), moved = plain;
  ParameterResult& p = moved.parameters[1];
  const double move = 3.0 * p.uncertainty.standard_error;
  p.gain_shift = GainShift{1.0, p.value + move};
  p.uncertainty = widened(p.uncertainty, p.value, job.free[1], move);
  const auto scatter = allow_for_scatter(job, plain);
  ASSERT_TRUE(scatter);
  ASSERT_GT(scatter->parameters[1].deviation, 0.0);
  ASSERT_TRUE(allow_for_scatter(job, moved));
  EXPECT_NEAR(p.uncertainty.standard_error,
              std::hypot(plain.parameters[1].uncertainty.standard_error, move), 1e-9 * p.value);
}

TEST(Scatter, OfRecordingsToValidateIsShownOnly) {
  Job job = scattering_machine(3, 0.0, 5);
  job.recordings[2].role = Role::validate;
  FitResult fit = estimate(job);
  const auto scatter = allow_for_scatter(job, fit);
  ASSERT_TRUE(scatter);
  EXPECT_EQ(scatter->groups.size(), 3u);
  EXPECT_EQ(scatter->fitted_groups(), 2u);
  EXPECT_FALSE(scatter->groups[2].fitted);
}

TEST(Scatter, OfOneRecordingIsThatOfItsStretches) {
  Job job = scattering_machine(1, 0.0, 6, 6.0);
  FitResult fit = estimate(job);
  const auto scatter = allow_for_scatter(job, fit);
  ASSERT_TRUE(scatter);
  EXPECT_TRUE(scatter->of_stretches);
  EXPECT_EQ(scatter->fitted_groups(), 6u);
  // What happens in a stretch of a free-running simulation depends on those before.
  job.options.observer = ObserverMode::none;
  FitResult free = estimate(job);
  EXPECT_FALSE(allow_for_scatter(job, free));
}

}  // namespace
}  // namespace axisfit
