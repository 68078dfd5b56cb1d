#include "sim/propagator.h"

#include <Eigen/Eigenvalues>

namespace axisfit {

std::vector<Oscillation> oscillations(const Matrix<double>& a) {
  constexpr int n = static_cast<int>(kStates);
  Eigen::Matrix<double, n, n> dense;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      dense(i, j) = a[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  std::vector<Oscillation> all;
  for (const std::complex<double>& rate : dense.eigenvalues())
    if (rate.imag() >= 0.0) all.push_back({rate.imag(), -rate.real()});
  std::ranges::sort(all, std::greater{}, &Oscillation::frequency);
  return all;
}

}  // namespace axisfit
