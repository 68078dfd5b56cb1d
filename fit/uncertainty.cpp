#include "fit/uncertainty.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace axisfit {

std::vector<ParameterUncertainty> uncertainty(const ParameterSpace& space, const Eigen::VectorXd& u,
                                              const Linearization& at_solution,
                                              double reduced_chi_square) {
  std::vector<ParameterUncertainty> result(space.size());
  std::vector<Eigen::Index> inside;
  for (std::size_t i = 0; i < space.size(); ++i) {
    const double lower = space.internal(i, space[i].lower),
                 upper = space.internal(i, space[i].upper);
    const double here = u[static_cast<Eigen::Index>(i)];
    const double near = 1e-6 * std::max(1.0, std::min(std::abs(here), upper - lower));
    result[i].at_bound = here - lower < near || upper - here < near;
    if (!result[i].at_bound) inside.push_back(static_cast<Eigen::Index>(i));
  }
  if (!at_solution.finite || inside.empty()) return result;

  // Columns of equal length: the rank must not depend on units. A column of zeros stays one.
  Eigen::MatrixXd j = at_solution.jacobian(Eigen::all, inside);
  Eigen::VectorXd length = j.colwise().norm();
  for (Eigen::Index k = 0; k < j.cols(); ++k) j.col(k) /= length[k] > 0.0 ? length[k] : 1.0;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(j, Eigen::ComputeThinV);
  const Eigen::VectorXd& s = svd.singularValues();
  const Eigen::MatrixXd& v = svd.matrixV();
  // Below this the exact Jacobian is rounding.
  const double negligible = 1e-9 * s[0];
  const double scale = std::sqrt(std::max(1.0, reduced_chi_square));
  for (Eigen::Index k = 0; k < j.cols(); ++k) {
    const auto i = static_cast<std::size_t>(inside[static_cast<std::size_t>(k)]);
    double variance = 0.0;
    bool open = !(length[k] > 0.0);
    for (Eigen::Index m = 0; m < s.size(); ++m) {
      if (s[m] > negligible)
        variance += std::pow(v(k, m) / s[m], 2);
      else if (std::abs(v(k, m)) > 0.1)
        open = true;
    }
    if (open) continue;
    const double error = scale * std::sqrt(variance) / length[k];  // of u
    const double here = u[static_cast<Eigen::Index>(i)];
    ParameterUncertainty& p = result[i];
    // An error of more than a factor of e, or one that spans the allowed range, is no knowledge.
    p.determined = space[i].logarithmic
                       ? error < 1.0
                       : 2.0 * 1.96 * error <
                             space.internal(i, space[i].upper) - space.internal(i, space[i].lower);
    if (!p.determined) continue;
    p.standard_error = error * space.slope(i, here);
    p.lower = std::max(space[i].lower, space.value(i, here - 1.96 * error));
    p.upper = std::min(space[i].upper, space.value(i, here + 1.96 * error));
  }
  return result;
}

}  // namespace axisfit
