#include "fit/errors/error_budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace axisfit {
namespace {

// Student's quantiles of 97.5 %, for eight and for two degrees of freedom.
constexpr double kOfEight = 2.3060041352042;
const double kOfTwo = 0.95 * std::sqrt(2.0 / (1.0 - 0.95 * 0.95));

FreeParameter between(double lower, double upper, bool logarithmic) {
  FreeParameter free;
  free.lower = lower;
  free.upper = upper;
  free.scale = logarithmic ? Scale::logarithmic : Scale::linear;
  return free;
}

const FreeParameter kLinear = between(-1000.0, 1000.0, false);
const FreeParameter kLogarithmic = between(0.1, 1000.0, true);

ErrorBudget sampling(double standard_error) {
  ErrorBudget budget;
  budget.sampling.standard_error = standard_error;
  budget.sampling.inflation = 1.5;
  budget.sampling.degrees_of_freedom = 8.0;
  return budget;
}

/// Of an estimate of ten on a linear scale.
void expect_total(const ErrorBudget& budget, double error, double student) {
  const ParameterUncertainty found = combined(budget, 10.0, kLinear);
  EXPECT_TRUE(found.determined);
  EXPECT_FALSE(found.weak);
  EXPECT_NEAR(found.standard_error, error, 1e-12 * error);
  EXPECT_NEAR(found.lower, 10.0 - student * error, 1e-10);
  EXPECT_NEAR(found.upper, 10.0 + student * error, 1e-10);
  // As many times that of white noise as before, and as it has grown.
  EXPECT_NEAR(found.inflation, 1.5 * error / budget.sampling.standard_error, 1e-12 * error);
}

TEST(ErrorBudget, OfSamplingAlone) { expect_total(sampling(3.0), 3.0, kOfEight); }

TEST(ErrorBudget, NoiseOfTheInputIsAFloor) {
  ErrorBudget budget = sampling(3.0);
  budget.input_noise = {2.9, 2.0};
  expect_total(budget, 3.0, kOfEight);
  budget.input_noise = {7.5, 2.0};
  expect_total(budget, 7.5, kOfTwo);
}

TEST(ErrorBudget, AMoveAtAnotherGainAddsInSquares) {
  ErrorBudget budget = sampling(3.0);
  for (const double value : {6.0, 14.0}) {
    budget.gain = {100.0, value};
    expect_total(budget, 5.0, kOfEight);
  }
}

TEST(ErrorBudget, AMoveWithARivalAddsInSquares) {
  ErrorBudget budget = sampling(3.0);
  budget.rival = {"one", "other", 6.0};
  expect_total(budget, 5.0, kOfEight);
  budget.gain = {100.0, 22.0};
  expect_total(budget, 13.0, kOfEight);
  expect_total(without_rival(budget), std::sqrt(153.0), kOfEight);
}

// Of a sum of which half is known with two degrees of freedom, and the rest well, there are eight.
TEST(ErrorBudget, ScatterTakesThePlaceOfWhatTheResidualHasOfIt) {
  ErrorBudget budget = sampling(6.0);
  budget.scatter = {.inside = 3.0, .between = 3.0, .degrees_of_freedom = 2.0};
  expect_total(budget, std::sqrt(18.0), kOfEight);
  EXPECT_DOUBLE_EQ(error_within_groups(budget, 10.0), 3.0);
  // But what is inside groups is never more than all.
  budget = sampling(3.0);
  budget.scatter = {.inside = 5.0, .between = 3.0, .degrees_of_freedom = 2.0};
  expect_total(budget, std::sqrt(18.0), kOfEight);
  EXPECT_DOUBLE_EQ(error_within_groups(budget, 10.0), 3.0);
}

TEST(ErrorBudget, ScatterLeavesTheMoveAtAnotherGain) {
  ErrorBudget budget = sampling(6.0);
  budget.gain = {100.0, 14.0};
  EXPECT_DOUBLE_EQ(error_within_groups(budget, 10.0), std::sqrt(52.0));
  budget.scatter = {.inside = 3.0, .between = 5.0, .degrees_of_freedom = 2.0};
  EXPECT_DOUBLE_EQ(error_within_groups(budget, 10.0), 5.0);
  expect_total(budget, std::sqrt(50.0), kOfEight);
}

TEST(ErrorBudget, ARivalWidensTheIntervalOfScatterInProportion) {
  ErrorBudget budget = sampling(6.0);
  budget.scatter = {.inside = 3.0, .between = 3.0, .degrees_of_freedom = 2.0};
  budget.rival = {"one", "other", 10.0 + std::sqrt(7.0)};
  expect_total(budget, 5.0, kOfEight);
  EXPECT_DOUBLE_EQ(error_within_groups(budget, 10.0), 3.0);
}

TEST(ErrorBudget, AnIntervalOnALogarithmicScaleIsAFactor) {
  ErrorBudget budget = sampling(1.0);
  ParameterUncertainty found = combined(budget, 10.0, kLogarithmic);
  EXPECT_DOUBLE_EQ(found.standard_error, 1.0);
  EXPECT_NEAR(found.lower, 10.0 * std::exp(-0.1 * kOfEight), 1e-10);
  EXPECT_NEAR(found.upper, 10.0 * std::exp(0.1 * kOfEight), 1e-10);
  budget.gain = {100.0, 10.75};
  found = combined(budget, 10.0, kLogarithmic);
  EXPECT_DOUBLE_EQ(found.standard_error, 1.25);
  EXPECT_NEAR(found.lower, 10.0 * std::exp(-0.125 * kOfEight), 1e-10);
}

/// A friction that was taken to be ten.
FreeParameter from_zero() {
  FreeParameter free = between(0.0, 1e6, false);
  free.scale = Scale::from_zero;
  free.initial = 10.0;
  return free;
}

TEST(ErrorBudget, AnIntervalFromZeroIsSymmetricAndReachesZero) {
  const ParameterUncertainty far = combined(sampling(1.0), 10.0, from_zero());
  EXPECT_EQ(far.verdict(), ParameterVerdict::determined);
  EXPECT_NEAR(far.lower, 10.0 - kOfEight, 1e-10);
  EXPECT_NEAR(far.upper, 10.0 + kOfEight, 1e-10);
  const ParameterUncertainty near = combined(sampling(3.0), 4.0, from_zero());
  EXPECT_EQ(near.verdict(), ParameterVerdict::at_zero);
  EXPECT_EQ(near.standard_error, 3.0);
  EXPECT_EQ(near.lower, 0.0);
  EXPECT_NEAR(near.upper, 4.0 + 3.0 * kOfEight, 1e-10);
}

TEST(ErrorBudget, WhatIsNeitherKnownNorSmallIsOpen) {
  EXPECT_EQ(combined(sampling(20.0), 4.0, from_zero()).verdict(), ParameterVerdict::not_determined);
  EXPECT_EQ(combined(sampling(8.0), 12.0, from_zero()).verdict(), ParameterVerdict::at_zero);
  EXPECT_EQ(combined(sampling(20.0), 12.0, from_zero()).verdict(),
            ParameterVerdict::not_determined);
}

TEST(ErrorBudget, AtZeroIsNotAtABound) {
  ErrorBudget budget = sampling(3.0);
  budget.sampling.at_bound = true;
  EXPECT_EQ(combined(budget, 0.0, from_zero()).verdict(), ParameterVerdict::at_zero);
  EXPECT_EQ(combined(budget, 0.0, between(0.0, 100.0, false)).verdict(), ParameterVerdict::at_zero);
  EXPECT_EQ(combined(budget, 100.0, between(0.0, 100.0, false)).verdict(),
            ParameterVerdict::at_bound);
  EXPECT_EQ(combined(budget, 5.0, between(5.0, 100.0, false)).verdict(),
            ParameterVerdict::at_bound);
  FreeParameter inertia = between(1e-9, 1e5, true);
  inertia.initial = 0.04;
  EXPECT_EQ(combined(budget, 1e-9, inertia).verdict(), ParameterVerdict::at_zero)
      << "it has no zero, but this is as good as none";
  inertia.initial = 1e-6;
  EXPECT_EQ(combined(budget, 1e-9, inertia).verdict(), ParameterVerdict::at_bound);
}

TEST(ErrorBudget, AnIntervalEndsAtTheBounds) {
  ParameterUncertainty found = combined(sampling(3.0), 10.0, between(5.0, 1000.0, false));
  EXPECT_EQ(found.lower, 5.0);
  EXPECT_NEAR(found.upper, 10.0 + 3.0 * kOfEight, 1e-10);
  found = combined(sampling(1.0), 10.0, between(0.1, 11.0, true));
  EXPECT_NEAR(found.lower, 10.0 * std::exp(-0.1 * kOfEight), 1e-10);
  EXPECT_EQ(found.upper, 11.0);
}

// Noise of three makes an interval of 3 t; of a minimum 4 t beyond the bound, 5 t - 4 t are left.
TEST(ErrorBudget, OfAnEstimateAtABoundIsOneSided) {
  ErrorBudget budget = sampling(3.0);
  budget.sampling.at_bound = true;
  for (const double inwards : {1.0, -1.0}) {
    const FreeParameter free =
        inwards > 0.0 ? between(0.0, 100.0, false) : between(-100.0, 0.0, false);
    const auto reach = [&](double step) {
      budget.sampling.step = step;
      const ParameterUncertainty found = combined(budget, 0.0, free);
      EXPECT_TRUE(found.at_bound);
      EXPECT_FALSE(found.determined);
      EXPECT_EQ(found.standard_error, 0.0);
      EXPECT_EQ(inwards > 0.0 ? found.lower : found.upper, 0.0);
      return inwards > 0.0 ? found.upper : -found.lower;
    };
    EXPECT_NEAR(reach(0.0), 3.0 * kOfEight, 1e-10);
    EXPECT_NEAR(reach(inwards), 3.0 * kOfEight, 1e-10);
    EXPECT_NEAR(reach(-4.0 * inwards * kOfEight), kOfEight, 1e-10);
  }
  budget = sampling(1.0);
  budget.sampling.at_bound = true;
  budget.input_noise = {2.0, 8.0};
  const ParameterUncertainty found = combined(budget, 10.0, between(0.1, 10.0, true));
  EXPECT_NEAR(found.lower, 10.0 * std::exp(-0.2 * kOfEight), 1e-10);
  EXPECT_EQ(found.upper, 10.0);
  EXPECT_DOUBLE_EQ(found.inflation, 3.0);
}

TEST(ErrorBudget, WhatNoiseLeavesOpenHasNoStandardError) {
  ErrorBudget open;  // nothing is known
  open.sampling.inflation = 7.0;
  for (const bool at_bound : {false, true}) {
    open.sampling.at_bound = at_bound;
    open.gain = {100.0, 14.0};
    open.rival = {"one", "other", 14.0};
    const ParameterUncertainty found = combined(open, 10.0, kLinear);
    EXPECT_FALSE(found.determined);
    EXPECT_EQ(found.at_bound, at_bound);
    EXPECT_EQ(found.standard_error, 0.0);
    EXPECT_FALSE(found.has_interval());
    EXPECT_EQ(found.inflation, 7.0);
  }
  // A decade by twice the error to either side, or an interval as wide as the bounds.
  const double decade = 0.25 * std::log(10.0);
  for (const double part : {0.2, 0.9, 1.1})
    for (const auto& [error, free] :
         {std::pair(10.0 * decade * part, kLogarithmic),
          std::pair(990.0 * part / kOfEight, between(-980.0, 1000.0, false))}) {
      const ParameterUncertainty found = combined(sampling(error), 10.0, free);
      EXPECT_EQ(found.determined, part < 1.0);
      EXPECT_EQ(found.weak, part == 0.9);
      EXPECT_EQ(found.has_interval(), part < 1.0);
      EXPECT_EQ(found.standard_error, part < 1.0 ? error : 0.0);
    }
}

// Whatever part of the budget makes it, an error beyond the value's order of magnitude leaves
// nothing to report.
TEST(ErrorBudget, EveryPartCountsWhereAnEstimateIsOpen) {
  const auto verdicts = [](double move) {
    ErrorBudget gain = sampling(1.0), rival = sampling(1.0), scatter = sampling(1.0);
    gain.gain = {100.0, 10.0 + move};
    rival.rival = {"one", "other", 10.0 - move};
    scatter.scatter = {1.0, move, 3.0};
    std::vector<ParameterVerdict> found;
    for (const ErrorBudget& budget : {gain, rival, scatter}) {
      const ParameterUncertainty known = combined(budget, 10.0, kLogarithmic);
      found.push_back(known.verdict());
      EXPECT_EQ(known.has_interval(), known.determined);
      EXPECT_NEAR(known.standard_error, known.determined ? std::hypot(1.0, move) : 0.0, 1e-12);
      EXPECT_NEAR(known.inflation, 1.5 * std::hypot(1.0, move), 1e-9);
    }
    return found;
  };
  using enum ParameterVerdict;
  EXPECT_THAT(verdicts(2.0), ::testing::Each(determined));
  EXPECT_THAT(verdicts(4.0), ::testing::Each(weakly_determined));
  EXPECT_THAT(verdicts(90.0), ::testing::Each(not_determined));
}

}  // namespace
}  // namespace axisfit
