#include "fit/errors/gain_sensitivity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

/// 30 s of a slide's position, with or without dry friction that the job does not have, tracked at
/// 9 1/s.
Job tracking_job(bool has_friction) {
  HiddenEffect friction = hidden_effect_named("coulomb_friction");
  if (!has_friction) friction.strengths[0].second = 0.0;
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  job.recordings = {recorded(friction.truth(), fit_motion(), 30.0, 3, {Signal::position})};
  job.options.observer = ObserverMode::fixed;
  job.options.observer_gain = 9.0;
  return job;
}

TEST(GainSensitivity, WidensWhatMovesWithIt) {
  const Job job = tracking_job(true);
  const FitResult before = estimate(job);
  FitResult after = before;
  allow_for_observer_gain(job, after);
  int moved = 0;
  for (std::size_t i = 0; i < after.parameters.size(); ++i) {
    const ParameterResult& p = after.parameters[i];
    EXPECT_EQ(p.value, before.parameters[i].value);
    if (!p.gain_shift) {
      EXPECT_EQ(p.uncertainty.standard_error, before.parameters[i].uncertainty.standard_error);
      continue;
    }
    ++moved;
    EXPECT_TRUE(p.gain_shift->observer_gain == 3.0 || p.gain_shift->observer_gain == 27.0);
    EXPECT_GT(p.uncertainty.standard_error, std::abs(p.gain_shift->value - p.value));
    EXPECT_LT(p.uncertainty.lower, p.gain_shift->value);
    EXPECT_GT(p.uncertainty.upper, p.gain_shift->value);
  }
  EXPECT_GT(moved, 0);
}

TEST(GainSensitivity, LeavesACompleteModelAlone) {
  const Job job = tracking_job(false);
  const FitResult before = estimate(job);
  FitResult after = before;
  allow_for_observer_gain(job, after);
  for (std::size_t i = 0; i < after.parameters.size(); ++i) {
    EXPECT_FALSE(after.parameters[i].gain_shift) << after.parameters[i].name;
    EXPECT_EQ(after.parameters[i].uncertainty.standard_error,
              before.parameters[i].uncertainty.standard_error);
  }
}

TEST(GainSensitivity, IsOfFixedObserversAlone) {
  Job job = tracking_job(true);
  FitResult fit = estimate(job);
  job.options.observer = ObserverMode::continuation;
  allow_for_observer_gain(job, fit);
  for (const ParameterResult& p : fit.parameters) EXPECT_FALSE(p.gain_shift);
}

TEST(GainSensitivity, WidensIntervalsOnTheirScale) {
  ParameterUncertainty known;
  known.determined = true;
  known.standard_error = 3.0;
  known.lower = 4.0;
  known.upper = 16.0;
  FreeParameter free;
  free.logarithmic = false;
  free.lower = -100.0;
  free.upper = 20.0;
  // Three and four make five.
  ParameterUncertainty wide = widened(known, 10.0, free, 4.0);
  EXPECT_DOUBLE_EQ(wide.standard_error, 5.0);
  EXPECT_DOUBLE_EQ(wide.lower, 0.0);
  EXPECT_DOUBLE_EQ(wide.upper, 20.0);
  free.lower = 0.0;
  free.upper = 1000.0;
  free.logarithmic = true;
  wide = widened(known, 8.0, free, 4.0);
  EXPECT_DOUBLE_EQ(wide.lower, 8.0 * std::pow(0.5, 5.0 / 3.0));
  EXPECT_DOUBLE_EQ(wide.upper, 8.0 * std::pow(2.0, 5.0 / 3.0));
  known.determined = false;
  EXPECT_EQ(widened(known, 8.0, free, 4.0).standard_error, 3.0);
}

}  // namespace
}  // namespace axisfit
