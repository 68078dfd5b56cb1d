#include "sim/propagator.h"

#include "base/linear_algebra.h"

namespace axisfit {

std::vector<Oscillation> oscillations(const Matrix<double>& a) {
  const Eigen::MatrixXd dense =
      Eigen::Map<const Eigen::Matrix<double, kStates, kStates, Eigen::RowMajor>>(a[0].data());
  std::vector<Oscillation> all;
  for (const std::complex<double>& rate : eigenvalues(dense))
    if (rate.imag() >= 0.0) all.push_back({rate.imag(), -rate.real()});
  std::ranges::sort(all, std::greater{}, &Oscillation::frequency);
  return all;
}

}  // namespace axisfit
