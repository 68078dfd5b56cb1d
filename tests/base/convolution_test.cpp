#include "base/convolution.h"

#include <gtest/gtest.h>

#include <cmath>

namespace axisfit {
namespace {

Eigen::MatrixXd some_columns(Eigen::Index rows) {
  Eigen::MatrixXd columns(rows, 2);
  for (Eigen::Index i = 0; i < rows; ++i)
    columns.row(i) << std::sin(0.7 * double(i * i)), 1.0 / double(i + 1);
  return columns;
}

TEST(Convolution, LaggedProductsAreTheirSums) {
  for (const Eigen::Index n : {1, 2, 7, 64, 100}) {
    const Eigen::VectorXd x = some_columns(n).col(0);
    const std::vector<double> products = lagged_products({x.data(), std::size_t(n)});
    ASSERT_EQ(products.size(), std::size_t(n));
    for (Eigen::Index lag = 0; lag < n; ++lag)
      EXPECT_NEAR(products[std::size_t(lag)], x.tail(n - lag).dot(x.head(n - lag)), 1e-13) << lag;
  }
}

TEST(Convolution, TheToeplitzProductIsThatOfTheMatrix) {
  for (const Eigen::Index n : {1, 5, 64, 100})
    for (const Eigen::Index length : {1, 2, 33, 100}) {
      if (length > n) continue;
      std::vector<double> kernel;
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
      for (Eigen::Index lag = 0; lag < length; ++lag) {
        kernel.push_back(std::cos(0.3 * double(lag)) * std::exp(-0.1 * double(lag)));
        for (Eigen::Index i = lag; i < n; ++i)
          matrix(i, i - lag) = matrix(i - lag, i) = kernel.back();
      }
      const Eigen::MatrixXd columns = some_columns(n);
      const Eigen::MatrixXd difference = toeplitz_product(kernel, columns) - matrix * columns;
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-13) << n << " " << length;
    }
}

}  // namespace
}  // namespace axisfit
