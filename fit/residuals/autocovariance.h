// The autocovariance of a residual: how its samples depend on their neighbours.
#pragma once

#include <span>
#include <vector>

namespace axisfit {

/// Autocovariances of a series about zero, from lag zero to where they have died away: those of
/// the autoregressive process that fits it, of the order that Schwarz's criterion chooses (zero for
/// white noise, and below 50 samples), by the recursion of Levinson and Durbin. Smooth where those
/// of the samples scatter, and never those of an impossible process.
///
/// Literature: P. J. Brockwell and R. A. Davis, Time Series: Theory and Methods, Springer 1991,
/// sections 8.2 and 9.3.
std::vector<double> modelled_autocovariance(std::span<const double> values);

}  // namespace axisfit
