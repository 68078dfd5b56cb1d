// Random numbers that are the same on every machine: the standard's distributions differ between
// libraries, its generators do not.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

namespace axisfit {

/// Uniform in [0, 1).
inline double uniform(std::mt19937_64& generator) {
  return std::ldexp(static_cast<double>(generator() >> 11), -53);
}

/// Normal, of mean zero and unit variance; G. E. P. Box and M. E. Muller (1958).
inline double normal(std::mt19937_64& generator) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(generator)));
  return radius * std::cos(2.0 * std::numbers::pi * uniform(generator));
}

}  // namespace axisfit
