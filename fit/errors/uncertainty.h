// Standard errors and intervals of the estimates, from the exact Jacobian at the solution.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fit/errors/error_budget.h"
#include "fit/solve/linearization.h"
#include "fit/solve/parameters.h"

namespace axisfit {

struct Uncertainty {
  std::vector<ErrorBudget> budgets;              ///< by parameter: sampling and noise of the input
  std::vector<ParameterUncertainty> parameters;  ///< what those come to
  /// Correlation of the estimates of u; not a number where a parameter has no standard error.
  Eigen::MatrixXd correlation;
  double degrees_of_freedom = 0.0;  ///< independent samples, parameters subtracted
  double autocorrelation_time =
      1.0;  ///< samples per independent sample, of the most coloured signal
  /// The part of noise of the input in the variance of an estimate, under noise of the stated
  /// sizes; the largest of all estimates.
  double input_part = 0.0;
};

/// Whether residuals with that autocorrelation time count as coloured.
bool is_coloured(double autocorrelation_time, const ErrorOptions& options = {});

/// Two estimates that are hardly determined apart: the first has the smaller place.
struct StrongCorrelation {
  std::size_t first = 0, second = 0;
  double value = 0.0;
};

/// The strongest first.
std::vector<StrongCorrelation> strong_correlations(const Eigen::MatrixXd& correlation,
                                                   const ErrorOptions& options = {});

/// Assumes a model that is linear over the intervals, and residuals that are, signal by signal,
/// stationary with the variance and the autocorrelation that they show, never less than the stated
/// noise: with J the whitened Jacobian and G the autocovariance of the residuals (see
/// residual_colour.h),
///
///   covariance = (J'J)^-1 J'G J (J'J)^-1
///
/// through a singular value decomposition of J, columns scaled. Intervals are Student's. Priors
/// count as one more measurement each. Where the inputs are noisy, no standard error is smaller
/// than white noise of the stated sizes, in readings and inputs, makes it (see input_noise.h): a
/// residual that drifts as slowly as that of a noisy input shows too little of itself in one
/// recording. A parameter at its bound has the interval inside it whose likelihood ratio is not
/// significant, with the others free; the others have theirs with it fixed.
///
/// Literature: E. A. Morelli and V. Klein, Journal of Aircraft 34 (1997), for coloured residuals;
/// G. A. F. Seber and C. J. Wild, Nonlinear Regression, Wiley 1989, sections 2.1 and 5.1.
Uncertainty uncertainty(const ParameterSpace& space, const Eigen::VectorXd& u,
                        const Linearization& at_solution, const ErrorOptions& options = {});

}  // namespace axisfit
