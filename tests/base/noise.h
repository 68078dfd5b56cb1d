// Noise with known properties, the same on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "base/random.h"

namespace axisfit {

/// White normal noise of unit variance.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : generator_(seed) {}
  double operator()() { return normal(generator_); }
  std::vector<double> values(std::size_t n) {
    std::vector<double> list(n);
    for (double& x : list) x = (*this)();
    return list;
  }

 private:
  std::mt19937_64 generator_;
};

/// A first-order autoregressive process with innovations of unit variance.
inline std::vector<double> autoregressive(double phi, std::size_t n, std::uint64_t seed) {
  Normal normal(seed);
  std::vector<double> values = normal.values(n);
  for (std::size_t i = 1; i < n; ++i) values[i] += phi * values[i - 1];
  return values;
}

/// All values times a factor.
inline std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& x : values) x *= factor;
  return values;
}

}  // namespace axisfit
