// The colour of residuals at a solution, and what it does to the errors of the estimates.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "fit/errors/error_options.h"
#include "fit/solve/linearization.h"

namespace axisfit {

/// The colour of whitened residuals at estimates with the Jacobian J.
struct ResidualColour {
  /// By series, from lag zero on; for white noise lag zero alone.
  std::vector<std::vector<double>> autocovariance;
  Eigen::MatrixXd middle;  ///< J'G J, with G of these autocovariances
};

/// The colour of the rows `series` of `residuals` and `j`; `inverse` is (J'J)^-1.
///
/// A series has the autocovariance of its autoregression, never less than the stated noise. The
/// estimates follow the residual, and take tr((J'J)^-1 J'G J) of its sum of squares tr(G): one
/// variance each if it is white, and far more if it is as slow as what they change. The
/// autocovariances are scaled up for it.
///
/// Literature: H. White, Econometrica 48 (1980), and J. G. MacKinnon and H. White, Journal of
/// Econometrics 29 (1985), for the same of residuals that are not equally large.
ResidualColour residual_colour(const Eigen::VectorXd& residuals, const Eigen::MatrixXd& j,
                               std::span<const SeriesRows> series, const Eigen::MatrixXd& inverse,
                               const ErrorOptions& options = {});

}  // namespace axisfit
