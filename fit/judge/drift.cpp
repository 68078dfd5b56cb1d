#include "fit/judge/drift.h"

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <vector>

#include "base/autocovariance.h"
#include "base/convolution.h"
#include "base/distributions.h"

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
  std::vector<double> t(n), residual(n);
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
    residual[i] = values[i] - mean - result.per_second * t[i];
    if (std::abs(residual[i]) < rounding) residual[i] = 0.0;  // its colour means nothing
  }

  // t'G t, as the meat in uncertainty.cpp
  const std::vector<double> g = modelled_autocovariance(residual);
  double correlation_length = 1.0, meat = g[0] * square;
  if (g.size() > 1) {
    correlation_length += 2.0 * std::accumulate(g.begin() + 1, g.end(), 0.0) / g[0];
    const Eigen::Map<const Eigen::VectorXd> line(t.data(), static_cast<Eigen::Index>(n));
    meat = line.dot(toeplitz_product(g, line).col(0));
  }
  meat = std::max(meat, std::max(g[0], rounding * rounding) * square);
  correlation_length = std::max(1.0, correlation_length);
  // The short models of Schwarz's criterion overlook slow noise beneath white noise. That sums of
  // white noise's own autocorrelation scatter by a tenth must not count.
  constexpr double kLonger = 1.2;
  if (const double time = autocorrelation_time(residual); time > kLonger * correlation_length) {
    meat *= time / correlation_length;
    correlation_length = time;
  }

  // A line fitted to coloured noise absorbs its slowest part, so that the residual has too little
  // variance and too short an autocorrelation time. Three more degrees of freedom make up for the
  // latter (the bias of an autoregression's coefficient, of the order of one over the number of
  // samples).
  const double independent = static_cast<double>(n) / correlation_length;
  const double degrees_of_freedom = independent - 2.0 - 3.0 * (1.0 - 1.0 / correlation_length);
  if (!(degrees_of_freedom >= 1.0)) return result;
  result.standard_error = std::sqrt(meat * independent / degrees_of_freedom) / square;
  if (!(result.standard_error > 0.0)) return result;
  result.p_value = 2.0 * student_upper_tail(std::abs(result.per_second) / result.standard_error,
                                            degrees_of_freedom);
  return result;
}

}  // namespace axisfit
