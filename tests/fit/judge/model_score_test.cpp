#include "fit/judge/model_score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// The slide with friction that the model does not have.
Job rubbing_slide() {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = 25.0;
  Job job;
  job.model = slide();
  job.recordings = {recorded(truth, LevelsMotion{{6, -6, -6, 6, 6, -6}, 0.4}, 2.4, 1,
                             {Signal::velocity, Signal::position})};
  return job;
}

TEST(ModelScore, HasTheErrorsOfEverySignal) {
  const Job job = rubbing_slide();
  const FitResult fit = result_at_start(job);
  const ModelScore score = score_of(job, fit);
  ASSERT_EQ(score.forces.size(), 1u);
  EXPECT_TRUE(score.forces[0].found);
  ASSERT_EQ(score.signals.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Measurement& m = job.recordings[0].measurements[i];
    const std::vector<double>& simulated = fit.recordings[0].free_running.simulated[i];
    double squares = 0.0;
    for (std::size_t k = 0; k < simulated.size(); ++k)
      squares += std::pow(m.values[k] - simulated[k], 2);
    const double rmse = std::sqrt(squares / static_cast<double>(simulated.size()));
    const auto [low, high] = std::ranges::minmax(m.values);
    EXPECT_FALSE(score.signals[i].tracking.has_value());
    ASSERT_TRUE(score.signals[i].free_running.has_value());
    const SignalErrors& errors = *score.signals[i].free_running;
    EXPECT_NEAR(errors.rmse, rmse, 1e-9 * rmse);
    EXPECT_NEAR(errors.nrmse_percent, 100.0 * rmse / (high - low), 1e-6);
    EXPECT_NEAR(errors.reduced_chi_square, std::pow(rmse / m.sigma, 2),
                1e-6 * std::pow(rmse / m.sigma, 2));
  }
}

TEST(ModelScore, TellsOfTrackingBesidesFreeRunning) {
  Job job = rubbing_slide();
  job.options.criterion = Tracking{50.0};
  const ModelScore score = score_of(job, evaluated(job));
  ASSERT_EQ(score.signals.size(), 2u);
  for (const SignalScore& signal : score.signals) {
    ASSERT_TRUE(signal.tracking.has_value());
    ASSERT_TRUE(signal.free_running.has_value());
    EXPECT_LT(signal.tracking->rmse, 0.5 * signal.free_running->rmse);
    EXPECT_EQ(signal.as_fitted()->rmse, signal.tracking->rmse);
  }
}

}  // namespace
}  // namespace axisfit
