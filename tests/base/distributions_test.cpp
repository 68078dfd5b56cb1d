#include "base/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace axisfit {
namespace {

// Closed forms: Student's t with one degree of freedom is Cauchy's distribution, chi-square with
// two an exponential one, and F with two and two degrees of freedom exceeds x with probability
// 1/(1+x).
TEST(Distributions, HaveTheirClosedForms) {
  constexpr double pi = std::numbers::pi;
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(normal_density(1.0), std::exp(-0.5) / std::sqrt(2.0 * pi), 1e-15);
  EXPECT_NEAR(student_quantile(0.975, 1.0), std::tan(0.475 * pi), 1e-9);
  EXPECT_NEAR(student_upper_quantile(0.1, 1.0), std::tan(0.4 * pi), 1e-12);
  EXPECT_NEAR(student_upper_tail(3.0, 1.0), 0.5 - std::atan(3.0) / pi, 1e-15);
  EXPECT_NEAR(chi_square_upper_quantile(0.01, 2.0), -2.0 * std::log(0.01), 1e-12);
  EXPECT_NEAR(fisher_upper_tail(4.0, 2.0, 2.0), 0.2, 1e-15);
}

}  // namespace
}  // namespace axisfit
