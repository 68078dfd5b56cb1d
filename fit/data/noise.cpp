#include "fit/data/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace axisfit {
namespace {

/// Differences below that part of the largest value are rounding errors of the computer.
constexpr double kRounding = 1e-12;

}  // namespace

double resolution_of(std::span<const double> values) {
  double size = 0.0, step = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double d = std::abs(values[i] - values[i - 1]);
    size = std::max(size, std::abs(values[i]));
    if (d > kRounding * size && (step == 0.0 || d < step)) step = d;
  }
  if (step == 0.0) return 0.0;
  // Small multiples only: over large ones the error of the step itself adds up.
  std::size_t moved = 0, on_grid = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double multiple = std::abs(values[i] - values[i - 1]) / step;
    if (multiple < 0.5 || multiple > 50.0) continue;
    ++moved;
    if (std::abs(multiple - std::round(multiple)) < 0.05) ++on_grid;
  }
  // By chance a tenth of the differences would be that close to a multiple.
  return moved > 8 && on_grid > 9 * moved / 10 ? step : 0.0;
}

namespace {

constexpr std::size_t kOrder = 6;
/// Sums of products of the binomial coefficients of the sixth order, with their signs, that are so
/// many places apart.
constexpr std::array<double, kOrder + 1> kGain{924.0, -792.0, 495.0, -220.0, 66.0, -12.0, 1.0};

/// Their standard deviation, by the median; of those larger than `least` alone, if it is given.
double spread_of_differences(std::span<const double> values, std::size_t stride,
                             double least = -1.0) {
  std::vector<double> d = sixth_differences(values, stride);
  for (double& x : d) x = std::abs(x);
  std::erase_if(d, [&](double x) { return x <= least; });
  if (d.size() < 3) return 0.0;
  const auto middle = d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2);
  std::nth_element(d.begin(), middle, d.end());
  return *middle / 0.6745;  // median of |N(0, 1)|
}

}  // namespace

std::vector<double> sixth_differences(std::span<const double> values, std::size_t stride) {
  if (values.size() <= kOrder * stride) return {};
  std::vector<double> d(values.begin(), values.end());
  for (std::size_t order = 0; order < kOrder; ++order) {
    for (std::size_t i = 0; i + stride < d.size(); ++i) d[i] = d[i + stride] - d[i];
    d.resize(d.size() - stride);
  }
  return d;
}

double noise_from_differences(std::span<const double> values) {
  double spread = spread_of_differences(values, 1);
  // A signal that is frozen at rest shows its noise only in motion.
  double size = 0.0;
  for (const double x : values) size = std::max(size, std::abs(x));
  if (const double rounding = kRounding * size; spread <= rounding)
    spread = std::max(spread, spread_of_differences(values, 1, rounding));
  return std::max(spread / std::sqrt(kGain[0]), resolution_of(values) / std::sqrt(12.0));
}

double noise_of_input(std::span<const double> values) {
  const double white = spread_of_differences(values, 1) / std::sqrt(kGain[0]);
  if (!(white > 0.0)) return 0.0;
  // The equal steps of a ramp are no rounding, which would make noise of their size.
  constexpr double kRamp = 0.1;
  const double rounding = resolution_of(values) / std::sqrt(12.0);
  // Values as far from each other as from their mean are levels that somebody chose.
  constexpr double kLevels = 0.5;
  if (white > kLevels * standard_deviation(values)) return 0.0;
  return white < kRamp * rounding ? white : noise_from_differences(values);
}

double standard_deviation(std::span<const double> values) {
  const double n = static_cast<double>(std::max<std::size_t>(1, values.size()));
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double sum = 0.0;
  for (const double x : values) sum += (x - mean) * (x - mean);
  return std::sqrt(sum / n);
}

double noise_from_differences(const Measurement& measurement) {
  std::vector<double> fresh;
  for (std::size_t i = 0; i < measurement.values.size(); ++i)
    if (measurement.uninformative.empty() || !measurement.uninformative[i])
      fresh.push_back(measurement.values[i]);
  if (measurement.filter == Filter()) return noise_from_differences(fresh);
  const double rounding = std::pow(resolution_of(fresh), 2) / 12.0;
  constexpr double kLeastPart = 0.003;
  for (std::size_t stride = 1; kOrder * stride + 3 <= fresh.size(); stride *= 2) {
    const std::vector<double> covariance =
        noise_autocovariance(measurement.filter, stride * measurement.hold, kGain.size());
    double part = covariance[0];
    for (std::size_t k = 1; k < kGain.size(); ++k)
      part += 2.0 * kGain[k] / kGain[0] * covariance[k];
    part /= covariance[0];
    if (part < kLeastPart) continue;
    const double variance = std::pow(spread_of_differences(fresh, stride), 2) / kGain[0];
    return std::sqrt(std::max(0.0, variance - rounding) / part + rounding);
  }
  return 0.0;
}

}  // namespace axisfit
