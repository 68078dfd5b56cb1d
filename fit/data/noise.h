// The noise of a recorded signal, from the recording alone.
#pragma once

#include <span>
#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// Standard deviation of the white part of a signal, in the signal's unit, from differences of the
/// sixth order of its samples, which leave next to nothing of a smooth signal; by the median of
/// their magnitudes, which a few jumps do not disturb. Assumes even sampling and normal noise,
/// white up to half the sampling rate. At least the standard deviation of rounding, where the
/// values lie on a grid (an encoder's). Zero for a constant signal; at least nine values are
/// needed, fewer give zero.
double noise_from_differences(std::span<const double> values);

/// The same for a recorded input; zero for a piecewise constant one, whose values lie on a grid
/// because somebody chose them, or for values that are as far from each other as from their mean,
/// and next to nothing for a ramp, whose steps are equal.
double noise_of_input(std::span<const double> values);

/// Standard deviation about the mean; zero for no values.
double standard_deviation(std::span<const double> values);

/// The same for a measurement that may be filtered or held: the standard deviation of the noise
/// after the filter, assumed white before it. Differences are taken between samples far enough
/// apart for the filter to leave them a part of that noise; only fresh samples count. Call
/// exclude_uninformative() first.
double noise_from_differences(const Measurement& measurement);

/// Differences of the sixth order of samples `stride` apart; empty where there are too few. Those
/// of white noise are sqrt(924) times as large as it.
std::vector<double> sixth_differences(std::span<const double> values, std::size_t stride);

/// The step of the grid on which the values lie; zero when they lie on none.
double resolution_of(std::span<const double> values);

}  // namespace axisfit
