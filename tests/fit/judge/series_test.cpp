#include "fit/judge/series.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <numbers>
#include <numeric>

#include "fit/data/noise.h"
#include "fit/judge/dependence.h"
#include "fit/judge/missing_force.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

std::vector<double> autoregressive(double phi, std::size_t n, std::uint64_t seed) {
  Normal normal(seed);
  std::vector<double> values = normal.values(n);
  for (std::size_t i = 1; i < n; ++i) values[i] += phi * values[i - 1];
  return values;
}

double mean_autocorrelation_time(double phi) {
  constexpr std::uint64_t kTrials = 10;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed)
    sum += autocorrelation_time(autoregressive(phi, 10000, seed));
  return sum / kTrials;
}

TEST(AutocorrelationTime, OfWhiteNoiseIsOneSample) {
  EXPECT_NEAR(mean_autocorrelation_time(0.0), 1.0, 0.05);
}

TEST(AutocorrelationTime, OfAFirstOrderProcessIsThatOfItsClosedForm) {
  for (const double phi : {0.5, 0.8, 0.95}) {
    const double exact = (1.0 + phi) / (1.0 - phi);
    EXPECT_NEAR(mean_autocorrelation_time(phi), exact, 0.1 * exact) << phi;
  }
}

TEST(AutocorrelationTime, IsNeverLessThanOneSample) {
  EXPECT_EQ(autocorrelation_time(autoregressive(-0.5, 1000, 1)), 1.0);
  EXPECT_EQ(autocorrelation_time(std::vector<double>(100, 3.0)), 1.0);
  EXPECT_EQ(autocorrelation_time(std::vector<double>{1.0, 2.0}), 1.0);
  EXPECT_EQ(autocorrelation_time(std::vector<double>{1.0}), 1.0);
  EXPECT_EQ(autocorrelation_time(std::vector<double>{}), 1.0);
}

/// Mean over some seeds of the variance along a wave of w rad per sample.
double mean_variance_along(double w, double phi) {
  constexpr std::uint64_t kTrials = 20;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    std::vector<double> wave(5000);
    for (std::size_t i = 0; i < wave.size(); ++i) wave[i] = std::sin(w * static_cast<double>(i));
    sum += variance_along(wave, autoregressive(phi, wave.size(), seed)) / kTrials;
  }
  return sum;
}

TEST(VarianceAlong, AWaveIsTheSpectrumAtItsFrequency) {
  for (const double phi : {0.0, 0.5, 0.95})
    for (const double w : {0.3, 1.0, 2.5}) {
      const double exact = 1.0 / (1.0 - 2.0 * phi * std::cos(w) + phi * phi);
      EXPECT_NEAR(mean_variance_along(w, phi), exact, 0.2 * exact) << phi << " " << w;
    }
}

TEST(VarianceAlong, ASlowChangeIsTheMeanSquareTimesTheAutocorrelationTime) {
  const double phi = 0.8, exact = 1.0 / std::pow(1.0 - phi, 2);
  EXPECT_NEAR(mean_variance_along(0.002, phi), exact, 0.3 * exact);
}

TEST(VarianceAlong, NoChangeIsThatOfASlowOne) {
  const std::vector<double> r = autoregressive(0.8, 5000, 1), none(r.size(), 0.0);
  EXPECT_EQ(variance_along(none, r), mean_square(r) * autocorrelation_time(r));
}

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

ResidualSeries series_of(std::vector<double> values) {
  ResidualSeries series;
  series.values = std::move(values);
  return series;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& x : values) x *= factor;
  return values;
}

TEST(IsExplained, AllowsForTheScatterOfAFewSamples) {
  // Mean square 1.21: more than five percent, and four standard errors for n > 1450.
  EXPECT_TRUE(is_explained(series_of(Normal(1).values(200))));
  EXPECT_TRUE(is_explained(series_of(Normal(1).values(20000))));
  EXPECT_TRUE(is_explained(series_of(scaled(Normal(1).values(200), 1.1))));
  EXPECT_FALSE(is_explained(series_of(scaled(Normal(1).values(20000), 1.1))));
  EXPECT_TRUE(is_explained(series_of(scaled(Normal(1).values(20000), 1.02))));
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

/// The paper's axis to and fro, with residuals by hand.
class DependenceTest : public testing::Test {
 protected:
  DependenceTest() {
    job_.model = paper_axis();
    job_.recordings = {
        recorded(job_.model, LevelsMotion{{8, -5, 3, -8, 2}, 0.3}, 1.5, 1, {Signal::velocity})};
    result_ = result_at_start(job_);
    measurement().sigma = 1.0;
    result_.recordings[0].free_running.simulated[0].assign(size(), 0.0);
  }
  std::size_t size() const { return job_.recordings[0].times.size(); }
  Measurement& measurement() { return job_.recordings[0].measurements[0]; }
  const Sample& sample(std::size_t i) const {
    return result_.recordings[0].free_running.samples[i];
  }

  SeriesTest test_of(std::vector<double> residuals) {
    measurement().values = std::move(residuals);
    const auto tests = test_residuals(job_, result_);
    EXPECT_EQ(tests.size(), 1u);
    return tests.front();
  }
  /// White noise and a part, by the number of the sample.
  SeriesTest test_with(const std::function<double(std::size_t)>& part) {
    std::vector<double> residuals = Normal(7).values(size());
    for (std::size_t i = 0; i < residuals.size(); ++i) residuals[i] += part(i);
    return test_of(std::move(residuals));
  }

  Job job_;
  FitResult result_;
};

TEST_F(DependenceTest, WhiteNoiseHasNone) {
  constexpr int kTrials = 1000;
  int with = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const SeriesTest test = test_of(Normal(static_cast<std::uint64_t>(trial) + 1).values(size()));
    with += test.dependences.empty() ? 0 : 1;
    EXPECT_TRUE(test.explained) << trial;
  }
  std::cout << with << " of " << kTrials << " trials show a dependence\n";
  EXPECT_LE(with, kTrials / 100);
}

// An analysis of variance that took every sample for independent would find many.
TEST_F(DependenceTest, ColouredNoiseHasHardlyAny) {
  constexpr int kTrials = 300;
  int with = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto seed = static_cast<std::uint64_t>(trial) + 1;
    with += test_of(autoregressive(0.8, size(), seed)).dependences.empty() ? 0 : 1;
  }
  std::cout << with << " of " << kTrials << " trials show a dependence\n";
  EXPECT_LE(with, kTrials * 3 / 100);
}

TEST_F(DependenceTest, OnThePositionIsFound) {
  const SeriesTest test =
      test_with([&](std::size_t i) { return 1.5 * std::sin(15.0 * sample(i).position); });
  ASSERT_FALSE(test.dependences.empty());
  EXPECT_EQ(test.dependences[0].on, "position");
  EXPECT_LT(test.dependences[0].p_value, 1e-6);
  EXPECT_FALSE(test.explained);
}

TEST_F(DependenceTest, OnTheDirectionIsFound) {
  const SeriesTest test =
      test_with([&](std::size_t i) { return sample(i).velocity > 0.0 ? -1.5 : 1.5; });
  ASSERT_FALSE(test.dependences.empty());
  // The velocity tells the direction, and may tell a little more of the noise.
  const auto direction = std::ranges::find(test.dependences, "direction", &Dependence::on);
  ASSERT_NE(direction, test.dependences.end());
  EXPECT_GT(direction->fraction, 0.99 * test.dependences[0].fraction);
  EXPECT_TRUE(test.dependences[0].on == "direction" || test.dependences[0].on == "velocity");
  EXPECT_GT(direction->fraction, 0.5);
}

TEST_F(DependenceTest, OnTheTimeIsFound) {
  const auto& times = job_.recordings[0].times;
  const SeriesTest test = test_with([&](std::size_t i) { return 4.0 * (times[i] - 0.75); });
  ASSERT_FALSE(test.dependences.empty());
  EXPECT_EQ(test.dependences[0].on, "time");
}

TEST_F(DependenceTest, OnAChannelIsFound) {
  job_.model.structure.channels = kept({{"oil", "degC", 20.0}});
  std::vector<double> oil;
  for (std::size_t i = 0; i < size(); ++i) oil.push_back(std::cos(0.031 * double(i)));
  job_.recordings[0].channels = {Samples(oil)};
  const SeriesTest test = test_with([&](std::size_t i) { return 1.5 * oil[i]; });
  ASSERT_FALSE(test.dependences.empty());
  EXPECT_EQ(test.dependences[0].on, "oil");
}

TEST_F(DependenceTest, OnTheMotorAngleIsFound) {
  const SeriesTest test =
      test_with([&](std::size_t i) { return 1.5 * std::sin(sample(i).motor_angle); });
  ASSERT_FALSE(test.dependences.empty());
  EXPECT_EQ(test.dependences[0].on, "motor angle");
}

TEST_F(DependenceTest, CountsWhatIsBeyondTheNoise) {
  const SeriesTest test = test_of(scaled(Normal(3).values(size()), 2.0));
  EXPECT_NEAR(test.reduced_chi_square, 4.0, 0.4);
  EXPECT_NEAR(test.unexplained_percent, 100.0 * std::sqrt(0.75), 3.0);
  EXPECT_EQ(test_of(scaled(Normal(3).values(size()), 0.5)).unexplained_percent, 0.0);
}

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

constexpr double kInterval = 1e-3;  // s

/// Amplitude behind the filter of a sine of the frequency f, Hz, away from the ends.
double gain(double f, double cutoff) {
  std::vector<double> sine(4001);
  for (std::size_t i = 0; i < sine.size(); ++i)
    sine[i] = std::sin(2.0 * std::numbers::pi * f * kInterval * static_cast<double>(i));
  const auto passed = low_pass(sine, kInterval, cutoff);
  // The frequencies below have whole numbers of periods in the middle second.
  double in = 0.0, out = 0.0;
  for (std::size_t i = 1500; i < 2500; ++i) {
    in += sine[i] * sine[i];
    out += sine[i] * passed[i];
  }
  return out / in;
}

TEST(LowPass, LetsAConstantThrough) {
  for (const double x : low_pass(std::vector<double>(500, 3.0), kInterval, 20.0))
    EXPECT_NEAR(x, 3.0, 1e-9);
}

TEST(LowPass, HasNoDelay) {
  std::vector<double> impulse(2001, 0.0);
  impulse[1000] = 1.0;
  const auto response = low_pass(impulse, kInterval, 20.0);
  EXPECT_NEAR(std::accumulate(response.begin(), response.end(), 0.0), 1.0, 1e-9);
  EXPECT_EQ(std::ranges::max_element(response) - response.begin(), 1000);
  for (std::size_t i = 1; i <= 1000; ++i)
    EXPECT_NEAR(response[1000 + i], response[1000 - i], 1e-10) << i;
}

TEST(LowPass, HalvesAtTheCutoffAndStopsBeyond) {
  EXPECT_NEAR(gain(2.0, 20.0), 1.0, 1e-3);
  EXPECT_NEAR(gain(20.0, 20.0), 0.5, 1e-3);
  EXPECT_NEAR(gain(18.0, 20.0), std::sqrt(0.5), 0.02);
  EXPECT_LT(std::abs(gain(40.0, 20.0)), 0.004);  // 1 / (1 + 2^8)
  EXPECT_LT(std::abs(gain(100.0, 20.0)), 1e-4);
}

TEST(LowPass, LeavesAloneWhatSamplingCannotSee) {
  const auto noise = Normal(1).values(100);
  EXPECT_EQ(low_pass(noise, kInterval, 490.0), noise);
  EXPECT_EQ(low_pass({1.0}, kInterval, 20.0), std::vector<double>{1.0});
  EXPECT_TRUE(low_pass({}, kInterval, 20.0).empty());
}

}  // namespace
}  // namespace axisfit
