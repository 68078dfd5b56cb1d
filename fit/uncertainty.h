// Standard errors of the estimates, from the exact Jacobian at the solution.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fit/solve.h"

namespace axisfit {

/// What the data say of the i-th parameter beyond its value.
struct ParameterUncertainty {
  bool at_bound = false;        ///< held by a bound; it has no standard error
  bool determined = false;      ///< false: the data leave it open, alone or together with others
  double standard_error = 0.0;  ///< in the quantity's unit; 0 unless determined
  double lower = 0.0, upper = 0.0;  ///< 95 % interval; on a logarithmic scale not symmetric
};

/// Assumes independent normal residuals and a model that is linear over the interval. Where the
/// residual is larger than the noise, errors grow with the root of the reduced chi-square: they
/// then describe scatter of the size of the residual, not of the noise.
///
/// Literature: G. A. F. Seber and C. J. Wild, Nonlinear Regression, Wiley 1989, sections 2.1
/// and 5.1.
std::vector<ParameterUncertainty> uncertainty(const ParameterSpace& space, const Eigen::VectorXd& u,
                                              const Linearization& at_solution,
                                              double reduced_chi_square);

}  // namespace axisfit
