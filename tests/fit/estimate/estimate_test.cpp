#include "fit/estimate/estimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// Poor guesses of two parameters that only the ringing and the rise show.
Job example_job() {
  Job job;
  job.model = paper_axis();
  job.recordings = {recorded_step(job.model)};
  job.free = {free_parameter("V_L", 8.0), free_parameter("k_g", 1.5e6)};
  return job;
}

/// Mass and friction of the slide from sixteen samples of its velocity.
Job slide_in_few_samples() {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"}, 6.0, {Signal::velocity});
  job.recordings.pop_back();
  Recording& r = job.recordings[0];
  const std::vector<double> times = r.times, values = r.measurements[0].values;
  r.times.edit().clear();
  r.measurements[0].values.edit().clear();
  for (std::size_t i = 0; i < times.size(); i += 80) {
    r.times.edit().push_back(times[i]);
    r.measurements[0].values.edit().push_back(values[i]);
  }
  return job;
}

/// Of the residuals of a recording's first measurement, in units of its noise.
double sum_of_squares(const Job& job, const FitResult& result, std::size_t recording,
                      std::size_t first = 0) {
  const Measurement& m = job.recordings[recording].measurements[0];
  const std::vector<double>& simulated = result.recordings[recording].free_running.simulated[0];
  double sum = 0.0;
  for (std::size_t i = first; i < m.values.size(); ++i)
    sum += std::pow((m.values[i] - simulated[i]) / m.sigma, 2);
  return sum;
}

TEST(Estimate, FindsTheTruthFromAPoorStart) {
  const FitResult result = estimate(example_job());
  ASSERT_TRUE(result.is_usable()) << result.message;
  EXPECT_TRUE(result.verdict.has_minimum());
  EXPECT_LT(result.reduced_chi_square, 1.1);
  EXPECT_EQ(result.observer_gain, 0.0);
  const double truth[] = {2.7, 5e6};
  for (std::size_t i = 0; i < 2; ++i) {
    const ParameterUncertainty& u = result.parameters[i].uncertainty;
    ASSERT_TRUE(u.determined);
    EXPECT_LT(std::abs(result.parameters[i].value - truth[i]), 4.0 * u.standard_error);
    EXPECT_LT(u.standard_error, 0.01 * truth[i]);
  }
}

// Without the observer the ringing leaves the fit in a local minimum: what continuation is for.
TEST(Estimate, NeedsTheContinuation) {
  Job job = example_job();
  job.options.continuation.reset();
  EXPECT_GT(estimate(job).reduced_chi_square, 2.0);
}

TEST(Estimate, IsTheSameForAnyNumberOfThreads) {
  Job job = example_job();
  job.options.starts = 3;
  job.options.threads = 1;
  const FitResult one = estimate(job);
  job.options.threads = 3;
  const FitResult three = estimate(job);
  ASSERT_EQ(one.starts.size(), 3u);
  for (std::size_t i = 0; i < one.parameters.size(); ++i)
    EXPECT_EQ(one.parameters[i].value, three.parameters[i].value);
  for (std::size_t s = 0; s < one.starts.size(); ++s) {
    EXPECT_EQ(one.starts[s].from, three.starts[s].from);
    EXPECT_EQ(one.starts[s].to, three.starts[s].to);
  }
}

TEST(Estimate, StartsLieWithinTheSpreadAndDifferBySeed) {
  Job job = example_job();
  EXPECT_EQ(draw_start(job, 0), (std::vector<double>{8.0, 1.5e6}));
  for (int start = 1; start < 50; ++start) {
    const std::vector<double> from = draw_start(job, start);
    EXPECT_LE(std::abs(std::log(from[0] / 8.0)), std::log(5.0) + 1e-12);
    EXPECT_NE(from, draw_start(job, start + 1));
  }
  const std::vector<double> first = draw_start(job, 1);
  EXPECT_EQ(draw_start(job, 1), first);
  job.options.seed = 2;
  EXPECT_NE(draw_start(job, 1), first);
}

TEST(Estimate, TakesAPriorForKnowledge) {
  Job job = example_job();
  // R hardly shows in a current-controlled axis: the prior decides.
  job.free.push_back(free_parameter("R", 1.0));
  job.free.back().prior = Prior{0.56, 0.001};
  const FitResult result = estimate(job);
  ASSERT_TRUE(result.is_usable());
  EXPECT_NEAR(result.parameters[2].value, 0.56, 0.004);
  EXPECT_GE(result.parameters[2].uncertainty.standard_error, 0.98 * 0.001);
  // Errors grow with the residual, never above the prior by more than that.
  EXPECT_LE(result.parameters[2].uncertainty.standard_error,
            0.001 * std::sqrt(std::max(1.0, result.reduced_chi_square)) * (1.0 + 1e-6));
}

TEST(Estimate, SharesParametersAndKeepsOthersPerRecording) {
  Job job = example_job();
  Model<double> loaded = job.model;
  loaded.axis.M = 161.0;
  Recording second = recorded_step(loaded, 3);
  second.name = "loaded";
  job.recordings.push_back(second);
  job.free[1] = free_parameter("M", 130.0);
  job.free[1].recording = 0;
  job.free.push_back(job.free[1]);
  job.free[2].recording = 1;
  const FitResult result = estimate(job);
  ASSERT_TRUE(result.is_usable()) << result.message;
  EXPECT_EQ(result.parameters[1].id, (ParameterId{quantity_index("M"), 0}));
  EXPECT_EQ(result.parameters[2].id, (ParameterId{quantity_index("M"), 1}));
  EXPECT_NEAR(result.parameters[1].value, 146.0,
              4.0 * result.parameters[1].uncertainty.standard_error);
  EXPECT_NEAR(result.parameters[2].value, 161.0,
              4.0 * result.parameters[2].uncertainty.standard_error);
}

TEST(Estimate, JudgesValidationRecordingsThatItDidNotFit) {
  Job job = example_job();
  Recording held_out = recorded_step(job.model, 5);
  held_out.name = "held out";
  held_out.role = Role::validate;
  job.recordings.push_back(held_out);
  const FitResult with = estimate(job);
  job.recordings.pop_back();
  const FitResult without = estimate(job);
  EXPECT_EQ(with.parameters[0].value, without.parameters[0].value);
  ASSERT_EQ(with.recordings.size(), 2u);
  EXPECT_FALSE(with.recordings[1].signals[0].fitted);
  EXPECT_NEAR(with.recordings[1].signals[0].reduced_chi_square, 1.0, 0.25);
}

TEST(Estimate, RefusesAModelThatCannotBeSimulated) {
  Job job = example_job();
  job.recordings[0].overrides.emplace_back(quantity_index("J_m"), std::nan(""));
  const FitResult result = estimate(job);
  EXPECT_FALSE(result.is_usable());
  EXPECT_EQ(result.verdict.kind, FitVerdict::Kind::not_simulated);
  EXPECT_EQ(result.verdict.kind, FitVerdict::Kind::not_simulated);
}

TEST(Estimate, RefusesAFitThatIsNoBetterThanAConstant) {
  Job job = example_job();
  for (double& v : job.recordings[0].measurements[0].values.edit()) v = -v;  // a wrong sign
  const FitResult result = estimate(job);
  EXPECT_FALSE(result.is_usable()) << result.message;
  EXPECT_EQ(result.verdict, (FitVerdict{.kind = FitVerdict::Kind::signal_not_followed,
                                        .signal = job.recordings[0].measurements[0].signal,
                                        .recording = 0}));
}

// A residual that is small beside the noise says nothing where the noise is taken from it.
TEST(Estimate, RefusesAHopelessFitUnlessTheNoiseIsKnownToBeLarge) {
  Job job = slide_in_few_samples();
  Measurement& m = job.recordings[0].measurements[0];
  for (double& v : m.values.edit()) v = -v;
  m.sigma = 10.0;
  EXPECT_TRUE(estimate(job).is_usable());
  m.noise = NoiseSource::fit;
  EXPECT_FALSE(estimate(job).is_usable());
}

TEST(Estimate, ReducedChiSquareCountsDegreesOfFreedom) {
  const Job job = slide_in_few_samples();
  const FitResult result = estimate(job);
  ASSERT_TRUE(result.is_usable()) << result.message;
  const double sum = sum_of_squares(job, result, 0);
  EXPECT_NEAR(result.reduced_chi_square, sum / (16.0 - 2.0), 1e-9 * sum);
  EXPECT_NEAR(result.recordings[0].signals[0].reduced_chi_square, sum / 16.0, 1e-9 * sum);
}

TEST(Estimate, LeavesOutInitialSamplesThatAreNotScored) {
  Job job = slide_in_few_samples();
  job.recordings.push_back(job.recordings[0]);
  Recording& judged = job.recordings[1];
  judged.name = "judged";
  judged.role = Role::validate;
  judged.initial_samples = 3;
  Measurement& m = judged.measurements[0];
  for (std::size_t i = 0; i < judged.initial_samples; ++i) m.values.edit()[i] += 1.0;  // m/s
  const auto rmse = [&](bool scored) {
    judged.score_initial_samples = scored;
    const FitResult result = estimate(job);
    const std::size_t first = scored ? 0 : judged.initial_samples;
    const double samples = static_cast<double>(m.values.size() - first);
    const double expected = m.sigma * std::sqrt(sum_of_squares(job, result, 1, first) / samples);
    EXPECT_NEAR(result.recordings[1].signals[0].rmse, expected, 1e-12);
    return expected;
  };
  EXPECT_NEAR(rmse(true), std::sqrt(3.0 / 16.0), 0.01);
  EXPECT_LT(rmse(false), 2.0 * m.sigma);
}

TEST(DistinctMinima, TakeEqualCostsTogether) {
  std::vector<StartResult> starts(5);
  const double costs[] = {1.0, 3.0, 1.0 + 1e-6, 0.0, 3.0001};
  for (std::size_t i = 0; i < 5; ++i) {
    starts[i].reduced_cost = costs[i];
    starts[i].usable = i != 3;
    starts[i].to = {double(i)};
  }
  const auto minima = distinct_minima(starts);
  ASSERT_EQ(minima.size(), 2u);
  EXPECT_EQ(minima[0].starts, 2);
  EXPECT_EQ(minima[0].values, std::vector<double>{0.0});
  EXPECT_EQ(minima[1].starts, 2);
  EXPECT_EQ(minima[1].reduced_cost, 3.0);
}

TEST(Estimate, KeepsTheStartsThatWereFinishedWhenItIsStopped) {
  Job job = example_job();
  job.options.starts = 3;
  job.options.threads = 1;
  StopFlag stop;
  const FitResult result = estimate(job, {&stop, nullptr, [&](const Progress& p) {
                                            if (p.done == 1) stop.set();
                                          }});
  EXPECT_TRUE(result.is_usable());
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(result.starts.size(), 1u);
  job.options.starts = 1;
  const FitResult first = estimate(job);
  EXPECT_FALSE(first.interrupted);
  for (std::size_t i = 0; i < first.parameters.size(); ++i)
    EXPECT_EQ(result.parameters[i].value, first.parameters[i].value);

  stop.set();
  EXPECT_THROW(estimate(job, {&stop}), Interrupted);
}

/// A slide whose instruments are of unknown quality: the first guesses of their noise are far off.
Job job_of_unknown_noise() {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  for (Recording& r : job.recordings)
    for (Measurement& m : r.measurements) {
      m.noise = NoiseSource::fit;
      m.sigma *= m.signal == Signal::velocity ? 20.0 : 0.3;
    }
  return job;
}

TEST(EstimateWithNoise, FindsTheNoiseOfEverySignal) {
  Job job = job_of_unknown_noise();
  const std::vector<FreeParameter> declared = job.free;
  const FitResult result = estimate_with_noise(job);
  ASSERT_TRUE(result.is_usable()) << result.message;
  EXPECT_NEAR(result.reduced_chi_square, 1.0, 1e-3);
  for (const Recording& r : job.recordings)
    for (const Measurement& m : r.measurements)
      EXPECT_NEAR(m.sigma, usual_noise(m.signal), 0.05 * usual_noise(m.signal));
  EXPECT_EQ(job.free[0].initial, declared[0].initial);
  // As if the noise had been known.
  const FitResult known = estimate(two_recordings(slide(), slide(), {"M", "B_a"}));
  for (std::size_t i = 0; i < 2; ++i) {
    const double error = known.parameters[i].uncertainty.standard_error;
    EXPECT_NEAR(result.parameters[i].uncertainty.standard_error, error, 0.05 * error);
    EXPECT_NEAR(result.parameters[i].value, known.parameters[i].value, 0.1 * error);
  }
}

TEST(EstimateWithNoise, CountsDegreesOfFreedom) {
  Job job = slide_in_few_samples();
  job.recordings[0].measurements[0].noise = NoiseSource::fit;
  const FitResult result = estimate_with_noise(job);
  ASSERT_TRUE(result.is_usable()) << result.message;
  EXPECT_NEAR(sum_of_squares(job, result, 0), 16.0 - 2.0, 0.01);
}

TEST(EstimateWithNoise, LeavesNoiseThatIsKnownAlone) {
  Job job = job_of_unknown_noise();
  job.recordings[0].measurements[0].noise = NoiseSource::given;
  const double given = job.recordings[0].measurements[0].sigma;
  estimate_with_noise(job);
  EXPECT_EQ(job.recordings[0].measurements[0].sigma, given);
  EXPECT_NEAR(job.recordings[0].measurements[1].sigma, usual_noise(Signal::acceleration),
              0.05 * usual_noise(Signal::acceleration));
}

}  // namespace
}  // namespace axisfit
