// Velocities and accelerations of recorded positions, by filters without delay.
#pragma once

#include <span>
#include <vector>

namespace axisfit {

/// Values (at `times`, s, increasing, two or more) at the instants of an even grid of as many,
/// `delay` (s) before each: linear in between, constant beyond both ends.
std::vector<double> on_even_grid(std::span<const double> times, std::span<const double> values,
                                 double delay = 0.0);

/// Derivative per second of values `interval` (s) apart; zero at both ends.
std::vector<double> central_differences(const std::vector<double>& values, double interval);

/// Standard deviation, per s^derivatives, of white noise of standard deviation one after so many
/// differentiations and a low-pass (Hz), for samples `interval` (s) apart.
double noise_gain(int derivatives, double cutoff, double interval);

/// The first or second derivative by time of values at even instants, `interval` (s) apart, behind
/// a low-pass at the highest cutoff of 40 Hz, 20 Hz, ... 1 Hz at which noise is no more than 3 % of
/// it. Noise in a derivative biases what is in proportion to it towards zero, by that part squared.
std::vector<double> derivative(const std::vector<double>& values, double interval, int order);

}  // namespace axisfit
