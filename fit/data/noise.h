// The noise of a recorded signal, from the recording alone.
#pragma once

#include <span>

namespace axisfit {

/// Standard deviation of the white part of a signal, in the signal's unit, from differences of the
/// sixth order of its samples, which leave next to nothing of a smooth signal; by the median of
/// their magnitudes, which a few jumps do not disturb. Assumes even sampling and normal noise,
/// white up to half the sampling rate. At least the standard deviation of rounding, where the
/// values lie on a grid (an encoder's). Zero for a constant signal; at least nine values are
/// needed, fewer give zero.
double noise_from_differences(std::span<const double> values);

/// The same of a recorded input; zero for one that is constant from step to step, whose values lie
/// on a grid because somebody chose them.
double noise_of_input(std::span<const double> values);

/// About the mean; zero for no values.
double standard_deviation(std::span<const double> values);

/// The step of the grid on which the values lie; zero when they lie on none.
double resolution_of(std::span<const double> values);

}  // namespace axisfit
