// Sums of lagged products in n log n steps, by fast Fourier transform.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace axisfit {

/// The sums over i of values[i] values[i - lag], for the lags 0 to values.size() - 1.
std::vector<double> lagged_products(std::span<const double> values);

/// Every column times the symmetric Toeplitz matrix whose first row begins with `kernel`, at most
/// as long as a column, and is zero behind it.
Eigen::MatrixXd toeplitz_product(std::span<const double> kernel, const Eigen::MatrixXd& columns);

}  // namespace axisfit
