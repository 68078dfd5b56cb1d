#include "base/linear_algebra.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

TEST(LinearAlgebra, LeastSquares) {
  Eigen::MatrixXd a(3, 2);
  a << 1, 0, 0, 2, 0, 0;
  const Eigen::Vector3d b(3, 4, 5);
  EXPECT_TRUE(LeastSquaresSolver(a).solve(b).isApprox(Eigen::Vector2d(3, 2)));
}

TEST(LinearAlgebra, OfDependentColumnsTheLeastNorm) {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Ones(4, 2);
  const LeastSquaresSolver solver(a);
  EXPECT_EQ(solver.rank(), 1);
  EXPECT_TRUE(solver.solve(Eigen::Vector4d::Constant(2.0)).isApprox(Eigen::Vector2d(1, 1)));
  EXPECT_TRUE(solver.basis().cwiseAbs().isApprox(Eigen::MatrixXd::Constant(4, 1, 0.5)));
}

TEST(LinearAlgebra, PivotsBelowTheThresholdCountAsZero) {
  const Eigen::MatrixXd a = Eigen::Vector2d(1.0, 1e-4).asDiagonal();
  EXPECT_EQ(LeastSquaresSolver(a).rank(), 2);
  EXPECT_EQ(LeastSquaresSolver(a, 1e-5).rank(), 2);
  EXPECT_EQ(LeastSquaresSolver(a, 1e-3).rank(), 1);
}

TEST(LinearAlgebra, SingularValuesDescend) {
  Eigen::MatrixXd a(3, 2);
  a << 0, 2, 0, 0, 5, 0;
  const auto [values, right] = singular_values(a);
  EXPECT_TRUE(values.isApprox(Eigen::Vector2d(5, 2)));
  EXPECT_TRUE((a * right).colwise().norm().transpose().isApprox(values));
}

TEST(LinearAlgebra, EigenvaluesOfAnOscillator) {
  Eigen::Matrix2d a;
  a << 0, 1, -9, 0;
  const Eigen::VectorXcd rates = eigenvalues(a);
  EXPECT_NEAR(std::abs(rates[0].imag()), 3.0, 1e-12);
  EXPECT_NEAR(rates[0].real(), 0.0, 1e-12);
}

}  // namespace
}  // namespace axisfit
