#include "fit/data/noise.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace axisfit {

double resolution_of(std::span<const double> values) {
  double size = 0.0, step = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double d = std::abs(values[i] - values[i - 1]);
    size = std::max(size, std::abs(values[i]));
    // Differences below rounding are zeros.
    if (d > 1e-12 * size && (step == 0.0 || d < step)) step = d;
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

/// What noise_from_differences() finds where there is no grid.
double white_part(std::span<const double> values) {
  constexpr std::size_t kOrder = 6;
  constexpr double kGain = 924.0;  // sum of the squared binomial coefficients of the sixth order
  if (values.size() < kOrder + 3) return 0.0;
  std::vector<double> d(values.begin(), values.end());
  for (std::size_t order = 0; order < kOrder; ++order) {
    for (std::size_t i = 0; i + 1 < d.size(); ++i) d[i] = d[i + 1] - d[i];
    d.pop_back();
  }
  for (double& x : d) x = std::abs(x);
  const auto middle = d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2);
  std::nth_element(d.begin(), middle, d.end());
  const double spread = *middle / 0.6745;  // median of |N(0, 1)|
  return spread / std::sqrt(kGain);
}

}  // namespace

double noise_from_differences(std::span<const double> values) {
  return std::max(white_part(values), resolution_of(values) / std::sqrt(12.0));
}

double noise_of_input(std::span<const double> values) {
  return white_part(values) > 0.0 ? noise_from_differences(values) : 0.0;
}

double standard_deviation(std::span<const double> values) {
  const double n = static_cast<double>(std::max<std::size_t>(1, values.size()));
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double sum = 0.0;
  for (const double x : values) sum += (x - mean) * (x - mean);
  return std::sqrt(sum / n);
}

}  // namespace axisfit
