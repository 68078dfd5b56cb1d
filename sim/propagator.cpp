#include "sim/propagator.h"

#include <Eigen/Eigenvalues>

namespace axisfit {

double fastest_oscillation(const Matrix<double>& a) {
  constexpr int n = static_cast<int>(kStates);
  Eigen::Matrix<double, n, n> dense;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      dense(i, j) = a[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return dense.eigenvalues().imag().cwiseAbs().maxCoeff();
}

}  // namespace axisfit
