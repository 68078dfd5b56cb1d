// One least-squares solution at one coupling.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fit/parameters.h"

namespace axisfit {

struct SolveOptions {
  int max_iterations = 50;
  double function_tolerance = 1e-8;   ///< relative change of the cost at which to stop
  double parameter_tolerance = 1e-9;  ///< relative change of the parameters at which to stop
  /// Whether to keep to the start, with the weight of one residual per e-fold of a parameter: what
  /// the data do not show then stays where it is instead of running off to a bound.
  bool keep_to_start = false;
};

struct SolveResult {
  bool usable = false;     ///< the point is finite and no worse than the start
  bool converged = false;  ///< a tolerance was reached
  Eigen::VectorXd u;
  double cost = 0.0;           ///< half the sum of squared residuals, priors included
  double reduced_cost = 0.0;   ///< 2 cost / number of residuals
  double coupling_rate = 0.0;  ///< as asked for
  int iterations = 0;
  std::string message;  ///< the solver's own reason to stop
};

/// Minimises over all `fit` recordings, from u, within the bounds, with the coupling's rate
/// (coupling_for each recording). Single-threaded and deterministic.
SolveResult solve(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                  double coupling_rate, const SolveOptions& options);

/// Where the residuals of one measurement of one recording stand.
struct SeriesRows {
  std::size_t recording = 0, measurement = 0;
  Eigen::Index first = 0, count = 0;
};

/// Residuals of all fit recordings and then of the priors at u, and their Jacobian with respect to
/// u.
struct Linearization {
  bool finite = false;
  std::vector<SeriesRows> series;
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
};
Linearization linearize(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                        double coupling_rate);

}  // namespace axisfit
