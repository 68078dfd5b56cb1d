#include "fit/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// Three linear parameters, none of them at its bounds, and a Jacobian given by hand.
class UncertaintyTest : public ::testing::Test {
 protected:
  UncertaintyTest() {
    job_.model = paper_axis();
    job_.recordings.resize(1);
    for (const char* name : {"B_a", "b_g", "k_g"}) {
      FreeParameter p = free_parameter(name, 1.0);
      p.logarithmic = false;
      p.lower = -1e6;
      p.upper = 1e6;
      job_.free.push_back(p);
    }
    linear_.finite = true;
    linear_.residuals = Eigen::VectorXd::Zero(4);
    linear_.jacobian.resize(4, 3);
  }
  Job job_;
  Linearization linear_;
};

TEST_F(UncertaintyTest, IsTheInverseOfTheNormalMatrix) {
  linear_.jacobian << 2, 0, 0, 0, 4, 0, 0, 0, 1, 0, 0, 0;
  const ParameterSpace space(job_);
  const auto u = uncertainty(space, Eigen::Vector3d(1, 1, 1), linear_, 1.0);
  EXPECT_NEAR(u[0].standard_error, 0.5, 1e-12);
  EXPECT_NEAR(u[1].standard_error, 0.25, 1e-12);
  EXPECT_NEAR(u[2].standard_error, 1.0, 1e-12);
  EXPECT_NEAR(u[2].upper - u[2].lower, 2 * 1.96, 1e-12);
}

TEST_F(UncertaintyTest, GrowsWithTheResidualButNeverShrinksBelowTheNoise) {
  linear_.jacobian << 2, 0, 0, 0, 4, 0, 0, 0, 1, 0, 0, 0;
  const ParameterSpace space(job_);
  EXPECT_NEAR(uncertainty(space, Eigen::Vector3d(1, 1, 1), linear_, 9.0)[0].standard_error, 1.5,
              1e-12);
  EXPECT_NEAR(uncertainty(space, Eigen::Vector3d(1, 1, 1), linear_, 0.5)[0].standard_error, 0.5,
              1e-12);
}

TEST_F(UncertaintyTest, SaysWhatTheDataLeaveOpen) {
  // Only the sum of the first two is seen, and the third is not seen at all.
  linear_.jacobian << 1, 1, 0, 2, 2, 0, 3, 3, 0, 1, 1, 0;
  const ParameterSpace space(job_);
  const auto u = uncertainty(space, Eigen::Vector3d(1, 1, 1), linear_, 1.0);
  for (const ParameterUncertainty& p : u) {
    EXPECT_FALSE(p.determined);
    EXPECT_FALSE(p.at_bound);
  }
}

TEST_F(UncertaintyTest, HoldsWhatIsAtABound) {
  linear_.jacobian << 2, 1, 0, 0, 4, 0, 0, 0, 1, 0, 0, 0;
  job_.free[1].upper = 1.0;
  const ParameterSpace space(job_);
  const auto u = uncertainty(space, Eigen::Vector3d(1, 1, 1), linear_, 1.0);
  EXPECT_TRUE(u[1].at_bound);
  EXPECT_FALSE(u[1].determined);
  EXPECT_NEAR(u[0].standard_error, 0.5, 1e-12);  // as if the second were known
}

TEST_F(UncertaintyTest, IntervalOfALogarithmIsAFactor) {
  linear_.jacobian << 10, 0, 0, 0, 4, 0, 0, 0, 1, 0, 0, 0;
  job_.free[0] = free_parameter("B_a", 200.0);
  const ParameterSpace space(job_);
  const auto u = uncertainty(space, Eigen::Vector3d(std::log(200.0), 1, 1), linear_, 1.0);
  EXPECT_NEAR(u[0].standard_error, 20.0, 1e-9);
  EXPECT_NEAR(u[0].lower, 200.0 * std::exp(-0.196), 1e-9);
  EXPECT_NEAR(u[0].upper, 200.0 * std::exp(0.196), 1e-9);
}

}  // namespace
}  // namespace axisfit
