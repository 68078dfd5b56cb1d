#include "fit/errors/input_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/parallel.h"
#include "fit/estimate/estimate.h"
#include "fit/judge/series.h"
#include "fit/solve/solve.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// A slide whose command was recorded with noise of `sigma` (V), which never reached the slide.
class InputNoiseTest : public testing::Test {
 protected:
  static Job job(double sigma, std::uint64_t seed = 1) {
    Job job = two_recordings(slide(), slide(), {"M", "B_a"}, 6.0, {Signal::velocity}, seed);
    job.options.continuation.reset();
    add_input_noise(job, sigma, seed);
    return job;
  }
  static Linearization at_start(const Job& job) {
    const ParameterSpace space(job);
    return linearize(job, space, start(job), 0.0);
  }
  static Eigen::VectorXd start(const Job& job) {
    std::vector<double> values;
    for (const FreeParameter& p : job.free) values.push_back(p.initial);
    return ParameterSpace(job).internal(values);
  }
  static std::optional<InputNoise> noise_of(const Job& job, const Linearization& at) {
    return input_noise(job, ParameterSpace(job), start(job), 0.0, at);
  }
};

TEST_F(InputNoiseTest, IsNothingWhereEveryInputIsExact) {
  const Job exact = job(0.0);
  EXPECT_FALSE(noise_of(exact, at_start(exact)));
  EXPECT_FALSE(estimate(exact).at_solution->input_noise);
}

TEST_F(InputNoiseTest, GrowsAsItsSize) {
  const Job small = job(0.01), large = job(0.02);
  const auto once = noise_of(small, at_start(small)), twice = noise_of(large, at_start(large));
  ASSERT_TRUE(once && twice);
  EXPECT_EQ(once->mean_squares.rows(), 1);
  EXPECT_NEAR(twice->mean_squares.mean() / once->mean_squares.mean(), 4.0, 0.01);
  EXPECT_NEAR(twice->gradients.norm() / once->gradients.norm(), 2.0, 0.01);
}

TEST_F(InputNoiseTest, DoesNotDependOnTheThreads) {
  const Job noisy = job(0.01);
  const auto alone = noise_of(noisy, at_start(noisy));
  const ThreadPool pool(2);
  EXPECT_EQ(noise_of(noisy, at_start(noisy))->gradients, alone->gradients);
}

// What was estimated from a command that moved the axis would leave more than there is.
TEST_F(InputNoiseTest, ThatWasEstimatedIsNoMoreThanTheResidualBears) {
  Job lively = job(0.2);
  for (Recording& r : lively.recordings) r.command_noise = NoiseSource::differences;
  Linearization at = at_start(lively);
  const double observed = at.residuals.squaredNorm() / static_cast<double>(at.residuals.size());
  const double likely = noise_of(lively, at)->mean_squares.mean();
  EXPECT_GT(likely, 0.2 * observed);
  at.residuals *= 1e-2;
  const InputNoise bearable = *noise_of(lively, at);
  EXPECT_NEAR(bearable.mean_squares.minCoeff(), 1e-4 * observed, 1e-6 * observed);
  for (Recording& r : lively.recordings) r.command_noise = NoiseSource::given;
  EXPECT_GT(noise_of(lively, at)->mean_squares.mean(), 10.0 * bearable.mean_squares.mean());
}

// From a fortieth of the noise of the reading to forty times that.
TEST_F(InputNoiseTest, IsInTheStandardErrors) {
  for (const double sigma : {0.01, 0.3}) {
    constexpr int kFits = 60;
    std::map<std::string, double> squares, held;
    for (std::uint64_t seed = 1; seed <= kFits; ++seed) {
      const FitResult fit = estimate(job(sigma, seed));
      for (const ParameterResult& p : fit.parameters) {
        ASSERT_TRUE(p.uncertainty.determined);
        const std::string& name = name_of(p.id);
        const double truth = name == "M" ? 20.0 : 30.0;
        squares[name] += std::pow((p.value - truth) / p.uncertainty.standard_error, 2) / kFits;
        held[name] += p.uncertainty.lower <= truth && truth <= p.uncertainty.upper;
      }
    }
    for (const auto& [name, square] : squares) {
      SCOPED_TRACE(name);
      EXPECT_GT(square, 0.5);  // a mean of 60 squares scatters by 0.18
      EXPECT_LT(square, 1.6);
      EXPECT_GE(held[name], 0.9 * kFits);
    }
  }
}

TEST_F(InputNoiseTest, ExplainsAResidualWhereItsSizeIsGiven) {
  Job noisy = job(0.3);
  const auto all_explained = [](const Job& job) {
    const FitResult fit = estimate(job);
    auto list = residual_series(job, fit);
    allow_for_parameters(job, fit, list);
    EXPECT_EQ(list.size(), 2u);
    for (const ResidualSeries& s : list) {
      EXPECT_GT(mean_square(s.values), 1.3) << s.fitted;
      EXPECT_TRUE(s.fitted || !s.input_noise_given || s.input_noise > 0.0);
    }
    return std::ranges::all_of(list, [](const ResidualSeries& s) { return is_explained(s); });
  };
  EXPECT_TRUE(all_explained(noisy));
  for (Recording& r : noisy.recordings) r.command_noise = NoiseSource::differences;
  EXPECT_FALSE(all_explained(noisy));
}

}  // namespace
}  // namespace axisfit
