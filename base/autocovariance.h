// The autocovariance of a series, such as a residual: how its samples depend on their neighbours.
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

/// Mean square.
double mean_square(std::span<const double> values);

/// How many samples carry as much information as one independent sample: 1 + 2 sum of the
/// autocorrelation, up to where pairs of it cease to be positive; at least 1.
/// Source: C. J. Geyer, Statistical Science 7 (1992), initial positive sequence.
double autocorrelation_time(std::span<const double> values);

/// Variance of a residual along a change of the prediction, per sample: of sum(change residual)
/// when they have nothing to do with each other, over sum(change^2). That of white noise is its
/// mean square; a slow drift of the residual counts little against a fast change, and much against
/// a slow one. The mean of the residual's spectrum over that of the change, the former smoothed by
/// Parzen's window: what was fitted leaves no hole in it. Where nothing changes, that along a slow
/// change. Literature: M. B. Priestley, Spectral Analysis and Time Series, 1981, section 6.2.
double variance_along(std::span<const double> change, std::span<const double> residual);

}  // namespace axisfit
