// The autocovariance of a residual: how its samples depend on their neighbours.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace axisfit {

/// A series in which every value is the sum of the last ones times coefficients, and an innovation.
struct Autoregression {
  std::vector<double> coefficients;  ///< of the last value, the one before, ...
  double innovation = 0.0;           ///< variance
};

/// That which fits a series about zero, given its autocovariances from lag zero on: the recursion
/// of Levinson and Durbin up to the order that Schwarz's criterion chooses for so many samples,
/// zero for white noise. Always stationary.
Autoregression fit_autoregression(std::span<const double> covariance, double samples);

/// Autocovariances of a series about zero, up to a lag.
std::vector<double> autocovariance(std::span<const double> values, std::size_t most);

/// Autocovariances of a series about zero, from lag zero to where they have died away: those of
/// its autoregression, white below 50 samples. Smooth where those of the samples scatter, and never
/// those of an impossible process.
///
/// Literature: P. J. Brockwell and R. A. Davis, Time Series: Theory and Methods, Springer 1991,
/// sections 8.2 and 9.3.
std::vector<double> modelled_autocovariance(std::span<const double> values);

}  // namespace axisfit
