#include "fit/residuals/drift.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <numeric>
#include <vector>

#include "fit/residuals/autocovariance.h"
#include "fit/residuals/series.h"

namespace axisfit {
namespace {

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

Drift drift(std::span<const double> times, std::span<const double> values) {
  Drift result;
  const std::size_t n = values.size();
  if (n < 3) return result;
  const double middle = mean_of(times), mean = mean_of(values);
  std::vector<double> t(n), rest(n);
  double square = 0.0, product = 0.0, size = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    t[i] = times[i] - middle;
    square += t[i] * t[i];
    product += t[i] * (values[i] - mean);
    size = std::max(size, std::abs(values[i]));
  }
  if (!(square > 0.0)) return result;
  result.per_second = product / square;
  result.span = result.per_second * (times.back() - times.front());
  const double rounding = 1e-12 * size;
  for (std::size_t i = 0; i < n; ++i) {
    rest[i] = values[i] - mean - result.per_second * t[i];
    if (std::abs(rest[i]) < rounding) rest[i] = 0.0;  // its colour means nothing
  }

  // t'G t, as the meat in uncertainty.cpp
  const std::vector<double> g = modelled_autocovariance(rest);
  double colour = 1.0, meat = g[0] * square;
  for (std::size_t lag = 1; lag < g.size(); ++lag) {
    colour += 2.0 * g[lag] / g[0];
    double sum = 0.0;
    for (std::size_t i = lag; i < n; ++i) sum += t[i] * t[i - lag];
    meat += 2.0 * g[lag] * sum;
  }
  meat = std::max(meat, std::max(g[0], rounding * rounding) * square);
  colour = std::max(1.0, colour);
  // The short models of Schwarz's criterion overlook slow noise beneath white noise. That sums of
  // white noise's own autocorrelation scatter by a tenth must not count.
  constexpr double kLonger = 1.2;
  if (const double time = autocorrelation_time(rest); time > kLonger * colour) {
    meat *= time / colour;
    colour = time;
  }

  // Of noise that is coloured, a line takes the slowest with it: the rest has too little variance
  // and too short a memory. Three more degrees of freedom make up for the latter (the bias of an
  // autoregression's coefficient, of the order of one over the number of samples).
  const double independent = static_cast<double>(n) / colour;
  const double freedom = independent - 2.0 - 3.0 * (1.0 - 1.0 / colour);
  if (!(freedom >= 1.0)) return result;
  result.standard_error = std::sqrt(meat * independent / freedom) / square;
  if (!(result.standard_error > 0.0)) return result;
  const boost::math::students_t by_chance(freedom);
  result.p_value =
      2.0 * cdf(complement(by_chance, std::abs(result.per_second) / result.standard_error));
  return result;
}

}  // namespace axisfit
