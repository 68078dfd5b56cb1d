#include "fit/judge/series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "fit/data/noise.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// A job and a result by hand: recordings of ten samples whose measured values are 10, 11, ... 19
/// and whose simulated values are zero, at a sigma of 2.
class ResidualSeriesTest : public testing::Test {
 protected:
  ResidualSeriesTest() { add_recording(); }
  void add_recording() {
    Recording& r = job_.recordings.emplace_back();
    r.times = instants(9, 0.1);
    Measurement& m = r.measurements.emplace_back();
    m.values.edit().resize(10);
    std::iota(m.values.edit().begin(), m.values.edit().end(), 10.0);
    m.sigma = 2.0;
    SimulatedRecording& p = result_.recordings.emplace_back().free_running;
    p.finished = true;
    p.simulated = {std::vector<double>(10, 0.0)};
  }
  Recording& recording() { return job_.recordings.front(); }
  Measurement& measurement() { return recording().measurements.front(); }

  Job job_;
  FitResult result_;
};

std::vector<bool> only(std::initializer_list<std::size_t> samples) {
  std::vector<bool> list(10);
  for (const std::size_t i : samples) list[i] = true;
  return list;
}

TEST_F(ResidualSeriesTest, AreTheErrorsInUnitsOfTheNoise) {
  const auto list = residual_series(job_, result_);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_TRUE(list[0].fitted);
  ASSERT_EQ(list[0].values.size(), 10u);
  EXPECT_EQ(list[0].values[3], 6.5);
  EXPECT_EQ(list[0].samples[3], 3u);
}

TEST_F(ResidualSeriesTest, OfARecordingToValidateAreNotFitted) {
  add_recording();
  job_.recordings[1].role = Role::validate;
  const auto list = residual_series(job_, result_);
  ASSERT_EQ(list.size(), 2u);
  EXPECT_TRUE(list[0].fitted);
  EXPECT_FALSE(list[1].fitted);
  EXPECT_EQ(list[1].recording, 1u);
  EXPECT_EQ(list[1].values.size(), 10u);
}

TEST_F(ResidualSeriesTest, LeaveOutWhatDoesNotCount) {
  measurement().excluded = only({0, 4});
  const auto list = residual_series(job_, result_);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].samples, (std::vector<std::size_t>{1, 2, 3, 5, 6, 7, 8, 9}));
}

TEST_F(ResidualSeriesTest, OfHeldOutSamplesAreASeriesOfTheirOwn) {
  recording().held_out = only({2, 3, 7});
  measurement().excluded = only({3, 8});
  const auto list = residual_series(job_, result_);
  ASSERT_EQ(list.size(), 2u);
  EXPECT_TRUE(list[0].fitted);
  EXPECT_EQ(list[0].samples, (std::vector<std::size_t>{0, 1, 4, 5, 6, 9}));
  EXPECT_FALSE(list[1].fitted);
  EXPECT_EQ(list[1].samples, (std::vector<std::size_t>{2, 7}));
  EXPECT_EQ(list[1].values, (std::vector<double>{6.0, 8.5}));
}

TEST_F(ResidualSeriesTest, BeginBehindInitialSamplesThatAreNotScored) {
  recording().initial_samples = 4;
  EXPECT_EQ(residual_series(job_, result_)[0].samples.front(), 0u);
  recording().score_initial_samples = false;
  EXPECT_EQ(residual_series(job_, result_)[0].samples.front(), 4u);
}

TEST_F(ResidualSeriesTest, LeaveOutComparedSignalsAndFailedSimulations) {
  add_recording();
  measurement().fitted = false;
  auto list = residual_series(job_, result_);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].recording, 1u);
  result_.recordings[1].free_running.finished = false;
  EXPECT_TRUE(residual_series(job_, result_).empty());
}

TEST_F(ResidualSeriesTest, AreThoseOfTheHeldSimulationWhereThatWasFitted) {
  SimulatedRecording tracking = result_.recordings[0].free_running;
  tracking.simulated[0].assign(10, 10.0);
  result_.recordings[0].tracking = tracking;
  EXPECT_EQ(residual_series(job_, result_)[0].values[3], 1.5);
}

TEST_F(ResidualSeriesTest, KnowWhatReadingsAddAtWhoseInstantAnEventPasses) {
  // Sampled every 100 ms: 2 ms to either side. The first mode is that of the start.
  result_.recordings[0].free_running.modes = {{0.0, {}}, {0.3015, {}}, {0.503, {}}, {0.7985, {}}};
  const ResidualSeries series = residual_series(job_, result_)[0];
  EXPECT_EQ(series.values[3], 6.5);
  EXPECT_EQ(series.values[8], 9.0);
  EXPECT_NEAR(series.at_events, (6.5 * 6.5 - 1.0 + 9.0 * 9.0 - 1.0) / 10.0, 1e-12);
}

ResidualSeries series_of(std::vector<double> values) {
  ResidualSeries series;
  series.values = std::move(values);
  return series;
}

TEST(IsExplained, AllowsForTheScatterOfAFewSamples) {
  // Mean square 1.21: more than five percent, and four standard errors for n > 1450.
  EXPECT_TRUE(is_explained(series_of(Normal(1).values(200))));
  EXPECT_TRUE(is_explained(series_of(Normal(1).values(20000))));
  EXPECT_TRUE(is_explained(series_of(scaled(Normal(1).values(200), 1.1))));
  EXPECT_FALSE(is_explained(series_of(scaled(Normal(1).values(20000), 1.1))));
  EXPECT_TRUE(is_explained(series_of(scaled(Normal(1).values(20000), 1.02))));
}

TEST(IsFittedToNoise, AsksFittedSeriesAlone) {
  ResidualSeries noise = series_of(Normal(1).values(2000)),
                 more = series_of(scaled(Normal(2).values(2000), 1.3));
  noise.fitted = true;
  more.fitted = false;
  EXPECT_TRUE(is_fitted_to_noise({noise, more}));
  more.fitted = true;
  EXPECT_FALSE(is_fitted_to_noise({noise, more}));
}

TEST(IsExplained, LeavesOutWhatEventsAtReadingsAdd) {
  ResidualSeries series = series_of(Normal(1).values(2000));
  series.values[700] = 15.0;
  EXPECT_FALSE(is_explained(series));
  series.at_events = (15.0 * 15.0 - 1.0) / 2000.0;
  EXPECT_TRUE(is_explained(series));
}

TEST(IsExplained, OfManySamplesIsFivePercent) {
  const auto values = Normal(1).values(20000);
  const auto of_mean_square = [&](double size) {
    return is_explained(series_of(scaled(values, std::sqrt(size / mean_square(values)))));
  };
  EXPECT_TRUE(of_mean_square(1.049));
  EXPECT_FALSE(of_mean_square(1.051));
  EXPECT_FALSE(of_mean_square(1.08));
}

// What a model lacks is coloured.
TEST(IsExplained, ColourExcusesNothing) {
  // Unit variance is scaled to a mean square of 1.21, with an autocorrelation time of 39 samples.
  const double deviation = 1.0 / std::sqrt(1.0 - 0.95 * 0.95);
  const auto values = scaled(autoregressive(0.95, 5000, 1), 1.1 / deviation);
  ASSERT_GT(mean_square(values), 1.1);
  EXPECT_FALSE(is_explained(series_of(values)));
  EXPECT_FALSE(is_explained(series_of(scaled(Normal(1).values(5000), 1.1))));
}

TEST(IsExplained, NoiseThatWasEstimatedScattersItself) {
  // In 1000 samples the mean square over the square of a noise from differences scatters by 10 %.
  int explained = 0, of_known = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto values = Normal(static_cast<std::uint64_t>(trial) + 1).values(1000);
    ResidualSeries series = series_of(scaled(values, 1.0 / noise_from_differences(values)));
    of_known += is_explained(series);
    series.noise = NoiseSource::differences;
    explained += is_explained(series);
  }
  EXPECT_GE(explained, kTrials - 1);
  EXPECT_LT(of_known, kTrials - 5);
}

}  // namespace
}  // namespace axisfit
