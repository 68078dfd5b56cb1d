#include "fit/estimate/other_gains.h"

#include <gtest/gtest.h>

#include "fit/errors/gain_error.h"
#include "tests/fit/estimate/tracking_job.h"

namespace axisfit {
namespace {

/// Of the parameters, those that move by more than their errors.
int moved(const FitResult& fit, const std::vector<FitResult>& others) {
  std::vector<EstimatesAtGain> estimates;
  for (const FitResult& other : others)
    estimates.push_back({other.observer_gain, other.parameters});
  const auto shifts = gain_errors(fit.parameters, estimates);
  return static_cast<int>(
      std::ranges::count_if(shifts, [](const auto& shift) { return shift.has_value(); }));
}

TEST(OtherGains, MoveWhatIsMissing) {
  const Job job = tracking_job(true);
  const FitResult fit = estimate(job);
  const std::vector<FitResult> others = fits_at_other_gains(job, fit);
  ASSERT_EQ(others.size(), 2u);
  EXPECT_EQ(others[0].observer_gain, 3.0);
  EXPECT_EQ(others[1].observer_gain, 27.0);
  EXPECT_GT(moved(fit, others), 0);
}

TEST(OtherGains, LeaveACompleteModelAlone) {
  const Job job = tracking_job(false);
  const FitResult fit = estimate(job);
  const std::vector<FitResult> others = fits_at_other_gains(job, fit);
  EXPECT_EQ(others.size(), 2u);
  EXPECT_EQ(moved(fit, others), 0);
}

TEST(OtherGains, AreOfUsableFitsWithFixedObserversAlone) {
  Job job = tracking_job(true);
  FitResult fit = estimate(job);
  fit.verdict.kind = FitVerdict::Kind::no_minimum;
  EXPECT_TRUE(fits_at_other_gains(job, fit).empty());
  fit.verdict.kind = FitVerdict::Kind::usable;
  job.options.criterion = FreeRun{};
  EXPECT_TRUE(fits_at_other_gains(job, fit).empty());
}

// One step from the fit tells of the move what the fits at those gains do.
TEST(LinearGainErrors, AreAboutThoseOfTheFits) {
  const Job job = tracking_job(true);
  FitResult fit = estimate(job), linear = fit;
  add_gain_errors(job, fit);
  add_linear_gain_errors(job, linear);
  int moves = 0;
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const auto& exact = fit.parameters[i].budget.gain;
    const auto& step = linear.parameters[i].budget.gain;
    ASSERT_EQ(exact.has_value(), step.has_value());
    if (!exact) continue;
    ++moves;
    EXPECT_EQ(step->observer_gain, exact->observer_gain);
    const double value = fit.parameters[i].value;
    EXPECT_NEAR(step->value - value, exact->value - value, 0.3 * std::abs(exact->value - value));
  }
  EXPECT_GT(moves, 0);
}

TEST(LinearGainErrors, AreNoneOfACompleteModelOrAFreeRun) {
  const auto has_any = [](const Job& job) {
    FitResult fit = estimate(job);
    add_linear_gain_errors(job, fit);
    return std::ranges::any_of(fit.parameters,
                               [](const ParameterResult& p) { return p.budget.gain.has_value(); });
  };
  EXPECT_FALSE(has_any(tracking_job(false)));
  Job free = tracking_job(true);
  free.options.criterion = FreeRun{};
  EXPECT_FALSE(has_any(free));
}

/// A fit that predicts the recording to validate with this error.
FitResult with_error(double gain, double percent, bool finished = true) {
  FitResult fit;
  fit.observer_gain = gain;
  fit.recordings.resize(2);
  for (RecordingResult& r : fit.recordings) r.signals.emplace_back();
  fit.recordings[0].signals[0].nrmse_percent = 1.0 / percent;  // that of the fitted does not count
  fit.recordings[1].signals[0].nrmse_percent = percent;
  fit.recordings[1].free_running.finished = finished;
  return fit;
}

TEST(BetterGain, IsTheBestThatIsAFifthBetter) {
  Job job = two_recordings(slide(), slide(), {"M"});
  const FitResult fit = with_error(10.0, 10.0);
  const auto better = [&](const FitResult& one, const FitResult& other) {
    return better_gain(job, fit, std::vector{one, other});
  };
  EXPECT_FALSE(better(with_error(3.0, 8.1), with_error(30.0, 11.0)));
  EXPECT_EQ(better(with_error(3.0, 7.9), with_error(30.0, 11.0)), 3.0);
  EXPECT_EQ(better(with_error(3.0, 7.0), with_error(30.0, 6.0)), 30.0);
  EXPECT_EQ(better(with_error(3.0, 7.0), with_error(30.0, 6.0, false)), 3.0);
  job.recordings[1].role = Role::fit;
  EXPECT_FALSE(better(with_error(3.0, 1.0), with_error(30.0, 1.0)));
}

}  // namespace
}  // namespace axisfit
