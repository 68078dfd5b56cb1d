#include "fit/first_look/noisy_regression.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/base/noise.h"

namespace axisfit {
namespace {

constexpr Eigen::Index kRows = 4000;

/// Two regressors that were read with noise, and what they make.
struct Read {
  Eigen::MatrixXd terms{kRows, 2}, noise = Eigen::MatrixXd::Zero(2, 2);
  Eigen::VectorXd inputs{kRows};

  explicit Read(double sigma) {
    Normal normal(5);
    for (Eigen::Index i = 0; i < kRows; ++i) {
      const double a = std::sin(0.1 * double(i)), b = std::cos(0.037 * double(i));
      inputs[i] = 2.0 * a - 3.0 * b;
      terms(i, 0) = a + sigma * normal();
      terms(i, 1) = b;
    }
    noise(0, 0) = sigma * sigma * double(kRows);
  }
};

TEST(NoisyRegression, SubtractsWhatNoiseAdds) {
  const Read read(0.4);
  const Eigen::VectorXd found = NoisyRegression(read.terms, read.noise).solve(read.inputs);
  EXPECT_NEAR(found[0], 2.0, 0.06);
  EXPECT_NEAR(found[1], -3.0, 0.03);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(2, 2);
  EXPECT_LT(NoisyRegression(read.terms, none).solve(read.inputs)[0], 1.6) << "it would be less";
}

TEST(NoisyRegression, LeavesOutWhatIsNoiseOrMadeByOthers) {
  Read read(0.0);
  read.noise(0, 0) = 0.6 * read.terms.col(0).squaredNorm();
  const NoisyRegression noisy(read.terms, read.noise);
  EXPECT_FALSE(noisy.has(0));
  EXPECT_TRUE(noisy.has(1));
  read.noise.setZero();
  read.terms.col(0) = 2.0 * read.terms.col(1);
  const NoisyRegression dependent(read.terms, read.noise);
  ASSERT_TRUE(dependent.is_possible());
  EXPECT_NE(dependent.has(0), dependent.has(1));
}

// Of white noise in the inputs it is that of least squares.
TEST(NoisyRegression, KnowsItsCovariance) {
  Read read(0.0);
  Normal normal(9);
  for (double& x : read.inputs) x += 0.5 * normal();
  const NoisyRegression regression(read.terms, read.noise);
  const Eigen::VectorXd left = regression.remaining(read.inputs);
  Balance::Rows all{0, std::vector<std::size_t>(kRows), 0, Window(8, 1.0), 0};
  const Eigen::MatrixXd covariance = regression.covariance(left, read.inputs, {all});
  const double usual = 0.25 / read.terms.col(0).squaredNorm();
  EXPECT_NEAR(covariance(0, 0), usual, 0.2 * usual);
}

}  // namespace
}  // namespace axisfit
