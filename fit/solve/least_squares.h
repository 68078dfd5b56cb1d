// Nonlinear least squares within bounds, and with priors, over a parameter space.
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/interrupt.h"
#include "fit/solve/linearization.h"
#include "fit/solve/parameters.h"

namespace axisfit {

/// Whitened residuals, each a function of one parameter block: the whole vector u of a space.
using Costs = std::vector<std::unique_ptr<ceres::CostFunction>>;

struct SolveOptions {
  int max_iterations = 50;
  double function_tolerance = 1e-8;   ///< relative change of the cost at which to stop
  double parameter_tolerance = 1e-9;  ///< relative change of the parameters at which to stop
  /// Penalizes the distance from the start, by one residual per e-fold of a parameter: a parameter
  /// that the data do not show then stays where it is instead of running off to a bound.
  bool penalize_distance_from_start = false;
  std::vector<std::size_t> fixed;  ///< parameters that stay as they are
  /// A reduced cost: a solution ends early, not converged, that would stay above it even if every
  /// iteration left to it did as much as the best of the last ones, or if it gained five times what
  /// the linearised costs promise.
  double give_up_above = std::numeric_limits<double>::infinity();
  /// The cost may jump, as that of a simulation does where an event passes the instant of a
  /// reading: a solution ends before a jump that bars little.
  bool jumps = false;
  const StopFlag* stop = nullptr;  ///< ends the solution, which is not usable then
};

struct SolveResult {
  bool usable = false;     ///< the point is finite and no worse than the start
  bool converged = false;  ///< a tolerance was reached
  Eigen::VectorXd u;
  double cost = 0.0;          ///< half the sum of squared residuals, priors included
  double reduced_cost = 0.0;  ///< 2 cost / number of residuals
  int iterations = 0;
  std::string message;  ///< the solver's own reason to stop
  /// Null where the solver did not evaluate it, and where the result is from a journal.
  std::shared_ptr<const Linearization> at_solution{};
};

/// Minimises the costs and the space's priors from u, within the space's bounds. The thread pool
/// evaluates costs side by side; the result does not depend on it.
SolveResult minimize(const ParameterSpace& space, Costs costs, const Eigen::VectorXd& u,
                     const SolveOptions& options);

/// Residuals and Jacobian of the costs, which the thread pool evaluates side by side, and of the
/// space's priors. All rows are one series.
Linearization linearize(const ParameterSpace& space, const Costs& costs, const Eigen::VectorXd& u);

/// The residuals alone; none where they are not finite.
Eigen::VectorXd residuals_at(const ParameterSpace& space, const Costs& costs,
                             const Eigen::VectorXd& u);

}  // namespace axisfit
