#include "fit/errors/residual_colour.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// Slow columns, of which many fit into a series, and their normal matrix's inverse.
struct Estimates {
  Eigen::MatrixXd j, inverse;
};

Estimates waves(Eigen::Index rows, Eigen::Index count) {
  Eigen::MatrixXd j(rows, count);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index k = 0; k < count; ++k)
      j(i, k) = std::cos(std::numbers::pi * double(k) * (double(i) + 0.5) / double(rows));
  return {j, (j.transpose() * j).inverse()};
}

/// Residuals that the estimates leave of an autoregressive series of variance four.
Eigen::VectorXd left(const Estimates& estimates, double colour, std::uint64_t seed) {
  Normal normal(seed);
  Eigen::VectorXd x(estimates.j.rows());
  x[0] = 2.0 * normal();
  for (Eigen::Index i = 1; i < x.size(); ++i)
    x[i] = colour * x[i - 1] + 2.0 * std::sqrt(1.0 - colour * colour) * normal();
  return x - estimates.j * (estimates.inverse * (estimates.j.transpose() * x));
}

TEST(ResidualColour, OfWhiteResidualsCountsEachEstimateOnce) {
  const Estimates estimates = waves(40, 10);
  const Eigen::VectorXd residuals = left(estimates, 0.0, 1);
  const SeriesRows rows{0, 0, 0, 40};
  const ResidualColour found =
      residual_colour(residuals, estimates.j, {&rows, 1}, estimates.inverse);
  EXPECT_NEAR(found.autocovariance[0][0], residuals.squaredNorm() / 30.0, 1e-9);
}

// Three slow estimates take a fifth of a slow residual: with one variance each counted, the
// variance that is found is a fifth too small.
TEST(ResidualColour, GivesBackWhatSlowEstimatesTookOfASlowResidual) {
  constexpr double kColour = 0.8;
  const Estimates estimates = waves(120, 3);
  const SeriesRows rows{0, 0, 0, 120};
  double variance = 0.0, plain = 0.0;
  constexpr int kSeries = 400;
  for (int seed = 1; seed <= kSeries; ++seed) {
    const Eigen::VectorXd residuals = left(estimates, kColour, static_cast<std::uint64_t>(seed));
    plain += residuals.squaredNorm() / 117.0 / kSeries;
    variance += residual_colour(residuals, estimates.j, {&rows, 1}, estimates.inverse)
                    .autocovariance[0][0] /
                kSeries;
  }
  EXPECT_LT(plain, 3.4);
  EXPECT_NEAR(variance, 4.0, 0.2);
}

TEST(ResidualColour, IsNeverLessThanTheStatedNoise) {
  const Estimates estimates = waves(100, 2);
  const SeriesRows rows[] = {{0, 0, 0, 50}, {0, 1, 50, 50}};
  const ResidualColour found =
      residual_colour(Eigen::VectorXd::Zero(100), estimates.j, rows, estimates.inverse);
  for (const std::vector<double>& g : found.autocovariance) EXPECT_EQ(g, std::vector<double>{1.0});
  EXPECT_TRUE(found.middle.isApprox(estimates.j.transpose() * estimates.j));
}

}  // namespace
}  // namespace axisfit
