#include "fit/errors/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/autocovariance.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// An autoregressive series of unit variance: x[t] = c x[t - 1] + white noise.
std::vector<double> coloured(double c, std::size_t n, std::uint64_t seed) {
  Normal normal(seed);
  std::vector<double> x(n, normal());
  for (std::size_t i = 1; i < n; ++i) x[i] = c * x[i - 1] + std::sqrt(1.0 - c * c) * normal();
  return x;
}

/// Three linear parameters, none of them at its bounds. The first two have columns of ones and of
/// alternating signs, the third one that is neither.
class UncertaintyTest : public ::testing::Test {
 protected:
  static constexpr Eigen::Index kRows = 4000;

  UncertaintyTest() {
    job_.model = paper_axis();
    job_.recordings.resize(1);
    for (const char* name : {"B_a", "b_g", "k_g"}) {
      FreeParameter p = free_parameter(name, 1.0);
      p.scale = Scale::linear;
      p.lower = -1e6;
      p.upper = 1e6;
      job_.free.push_back(p);
    }
    linear_.finite = true;
    linear_.jacobian.resize(kRows, 3);
    for (Eigen::Index i = 0; i < kRows; ++i)
      linear_.jacobian.row(i) << 1.0, i % 2 == 0 ? 1.0 : -1.0, i % 4 < 2 ? 1.0 : -1.0;
    linear_.series = {{0, 0, 0, kRows}};
    residuals(Normal(1).values(kRows));
  }
  void residuals(const std::vector<double>& values) {
    linear_.residuals = Eigen::Map<const Eigen::VectorXd>(values.data(), kRows);
    // As at a solution: no step improves it.
    linear_.residuals -=
        linear_.jacobian * (linear_.jacobian.transpose() * linear_.residuals) / double(kRows);
  }
  Uncertainty found(const Eigen::Vector3d& u = {1, 1, 1}) const {
    return uncertainty(ParameterSpace(job_), u, linear_);
  }

  Job job_;
  Linearization linear_;
};

const double kWhite = 1.0 / std::sqrt(4000.0);

TEST_F(UncertaintyTest, OfWhiteResidualsIsTheInverseOfTheNormalMatrix) {
  const Uncertainty u = found();
  for (const ParameterUncertainty& p : u.parameters) {
    EXPECT_TRUE(p.determined);
    EXPECT_FALSE(p.weak);
    EXPECT_NEAR(p.standard_error, kWhite, 0.03 * kWhite);
    EXPECT_NEAR(p.upper - p.lower, 2 * 1.9605 * p.standard_error, 1e-3 * p.standard_error);
  }
  EXPECT_EQ(u.autocorrelation_time, 1.0);
  EXPECT_EQ(u.degrees_of_freedom, double(kRows - 3));
  EXPECT_NEAR(u.correlation(0, 0), 1.0, 1e-12);
  EXPECT_NEAR(u.correlation(0, 1), 0.0, 1e-12);
}

TEST_F(UncertaintyTest, GrowsWithTheResidualButNeverShrinksBelowTheNoise) {
  std::vector<double> values = Normal(1).values(kRows);
  for (double& x : values) x *= 3.0;
  residuals(values);
  EXPECT_NEAR(found().parameters[0].standard_error, 3.0 * kWhite, 0.1 * kWhite);
  for (double& x : values) x /= 6.0;
  residuals(values);
  EXPECT_NEAR(found().parameters[0].standard_error, kWhite, 1e-3 * kWhite);
}

// Slow noise hides what is slow, and hides what is fast the less.
TEST_F(UncertaintyTest, AllowsForColour) {
  constexpr double kColour = 0.8;
  residuals(coloured(kColour, kRows, 5));
  const Uncertainty u = found();
  const double slow = std::sqrt((1.0 + kColour) / (1.0 - kColour));
  EXPECT_NEAR(u.parameters[0].standard_error, slow * kWhite, 0.15 * slow * kWhite);
  EXPECT_NEAR(u.parameters[1].standard_error, kWhite / slow, 0.15 * kWhite / slow);
  EXPECT_NEAR(u.autocorrelation_time, slow * slow, 0.3 * slow * slow);
}

TEST_F(UncertaintyTest, CountsAPriorAsAMeasurement) {
  linear_.jacobian.conservativeResize(kRows + 1, 3);
  linear_.jacobian.row(kRows) << 1.0 / kWhite, 0.0, 0.0;  // as much as all samples together
  linear_.residuals.conservativeResize(kRows + 1);
  linear_.residuals[kRows] = 0.0;
  EXPECT_NEAR(found().parameters[0].standard_error, kWhite / std::sqrt(2.0), 0.03 * kWhite);
}

TEST_F(UncertaintyTest, SaysWhatTheDataLeaveOpen) {
  // Only the sum of the first two is seen, and the third is not seen at all.
  linear_.jacobian.col(1) = linear_.jacobian.col(0);
  linear_.jacobian.col(2).setZero();
  const Uncertainty u = found();
  for (const ParameterUncertainty& p : u.parameters) {
    EXPECT_FALSE(p.determined);
    EXPECT_FALSE(p.at_bound);
    EXPECT_FALSE(p.has_interval());
  }
  EXPECT_TRUE(u.correlation.array().isNaN().all());
}

TEST_F(UncertaintyTest, HoldsWhatIsAtABound) {
  linear_.jacobian.col(0) += linear_.jacobian.col(1);
  job_.free[1].upper = 1.0;
  const Uncertainty u = found();
  EXPECT_TRUE(u.parameters[1].at_bound);
  EXPECT_FALSE(u.parameters[1].determined);
  // As if the second were known.
  EXPECT_NEAR(u.parameters[0].standard_error, kWhite / std::sqrt(2.0), 0.03 * kWhite);
  // The minimum is on the bound, and the other side is as far as in any interval.
  EXPECT_EQ(u.parameters[1].upper, 1.0);
  EXPECT_NEAR(1.0 - u.parameters[1].lower, 1.96 * std::sqrt(2.0) * kWhite, 0.1 * kWhite);
}

TEST_F(UncertaintyTest, AMinimumBeyondABoundLeavesLessInside) {
  job_.free[1].upper = 1.0;
  linear_.residuals -= 3.0 * kWhite * linear_.jacobian.col(1);  // 3 standard errors beyond
  const double inside = 1.0 - found().parameters[1].lower;
  EXPECT_NEAR(inside, (std::sqrt(1.96 * 1.96 + 9.0) - 3.0) * kWhite, 0.05 * kWhite);
}

TEST_F(UncertaintyTest, IntervalOfALogarithmIsAFactor) {
  linear_.jacobian.col(0) *= 10.0 * kWhite;
  job_.free[0] = free_parameter("M", 200.0);
  const ParameterUncertainty p = found({std::log(200.0), 1, 1}).parameters[0];
  EXPECT_NEAR(p.standard_error, 20.0, 0.6);
  const double factor = std::exp(1.9605 * p.standard_error / 200.0);
  EXPECT_NEAR(p.lower, 200.0 / factor, 0.01);
  EXPECT_NEAR(p.upper, 200.0 * factor, 0.01);
}

TEST_F(UncertaintyTest, AFactorOfSomeSizeIsWeak) {
  linear_.jacobian.col(0) *= 2.0 * kWhite;
  job_.free[0] = free_parameter("M", 200.0);
  const ParameterUncertainty p = found({std::log(200.0), 1, 1}).parameters[0];
  EXPECT_TRUE(p.determined);
  EXPECT_TRUE(p.weak);
}

// On a linear scale the interval is compared with the range that is allowed.
TEST_F(UncertaintyTest, AnIntervalAsWideAsItsBoundsIsNoKnowledge) {
  const double half = 1.9605 * kWhite;  // of the interval
  for (const double part : {0.8, 1.2}) {
    job_.free[0].lower = 1.0 - half / part;
    job_.free[0].upper = 1.0 + half / part;
    const ParameterUncertainty p = found().parameters[0];
    EXPECT_FALSE(p.at_bound);
    EXPECT_EQ(p.determined, part < 1.0);
    EXPECT_EQ(p.weak, part < 1.0);
    EXPECT_EQ(p.has_interval(), part < 1.0);
  }
}

TEST(ColouredResiduals, OfWhiteNoiseIsNone) {
  int with = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed)
    with += modelled_autocovariance(Normal(seed).values(1000)).size() > 1 ? 1 : 0;
  EXPECT_LE(with, 5);
}

TEST(ColouredResiduals, IsThatOfTheProcess) {
  for (const double c : {-0.5, 0.5, 0.95}) {
    const auto g = modelled_autocovariance(coloured(c, 20000, 3));
    ASSERT_GT(g.size(), 5u);
    for (std::size_t lag = 0; lag < 5; ++lag)
      EXPECT_NEAR(g[lag], std::pow(c, lag), 0.15) << c << " " << lag;
  }
  EXPECT_EQ(modelled_autocovariance(std::vector<double>(50, 0.0)), std::vector<double>{0.0});
}

}  // namespace
}  // namespace axisfit
