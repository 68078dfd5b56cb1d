#include "fit/judge/dependence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

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

}  // namespace
}  // namespace axisfit
