#include "fit/judge/outliers.h"

#include <algorithm>
#include <cmath>

#include "base/distributions.h"

namespace axisfit {
namespace {

/// The magnitude that this part of standard normal values stays below.
double normal_magnitude(double part) { return normal_quantile(0.5 + 0.5 * part); }

/// Standard deviation of normal deviations, by the magnitude that this part of them stays below.
double scale(std::span<const double> magnitudes, double part) {
  std::vector<double> sorted(magnitudes.begin(), magnitudes.end());
  const auto rank = static_cast<std::ptrdiff_t>(part * static_cast<double>(sorted.size()));
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  return sorted[static_cast<std::size_t>(rank)] / normal_magnitude(part);
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// What a scale may lack because values are rounded: half a step of the grid on which they lie, or
/// of the digits of a double. Next to nothing where there is no grid.
double rounding_error(std::span<const double> values) {
  double size = 0.0, step = INFINITY;
  for (const double x : values) size = std::max(size, std::abs(x));
  const double rounding = 1e-12 * size;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (const double d = std::abs(values[i] - values[i - 1]); d > rounding)
      step = std::min(step, d);
  return std::isfinite(step) ? 0.5 * step : rounding;
}

/// How many scales normal deviations, so many of them, hardly ever reach. The scale is itself an
/// estimate, as certain as a standard deviation of so many degrees of freedom (from the variance of
/// a sample quantile). It is less certain in coloured noise, but there neighbours go along.
double threshold(std::size_t deviations, const OutlierOptions& options) {
  const double n = static_cast<double>(deviations);
  const double q = normal_magnitude(options.scale_part);
  const double degrees_of_freedom = n * 2.0 * std::pow(q * normal_density(q), 2) /
                                    (options.scale_part * (1.0 - options.scale_part));
  return student_upper_quantile(0.5 * options.false_alarms / n, degrees_of_freedom);
}

/// Whether a sample departs from `level` and returns, within a burst, and next to nothing around
/// goes as far.
bool is_alone(std::span<const double> values, std::size_t at, double level,
              const OutlierOptions& options) {
  const double limit = options.alone * std::abs(values[at] - level);
  const auto beyond = [&](std::size_t i) { return std::abs(values[i] - level) > limit; };
  std::size_t first = at, last = at;
  while (first > 0 && last - first < options.burst && beyond(first - 1)) --first;
  while (last + 1 < values.size() && last - first < options.burst && beyond(last + 1)) ++last;
  if (last - first >= options.burst || first < 2 || last + 2 >= values.size()) return false;
  // Others nearby: noise, or a second spike.
  std::size_t others = 0;
  for (std::size_t i = at - std::min(at, options.neighbours); i < first; ++i) others += beyond(i);
  for (std::size_t i = last + 1; i <= std::min(values.size() - 1, at + options.neighbours); ++i)
    others += beyond(i);
  return others <= (first == last ? 2u : 1u);
}

}  // namespace

std::vector<std::size_t> outliers(std::span<const double> residuals,
                                  const OutlierOptions& options) {
  const std::size_t n = residuals.size();
  if (n < options.fewest_samples) return {};
  std::vector<double> level(n), magnitude(n), neighbours;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t begin = i - std::min(i, options.neighbours);
    const std::size_t end = std::min(n, i + 1 + options.neighbours);
    neighbours.clear();
    for (std::size_t k = begin; k < end; ++k)
      if (k != i) neighbours.push_back(residuals[k]);
    level[i] = median(neighbours);
    magnitude[i] = std::abs(residuals[i] - level[i]);
  }
  const double rounding = rounding_error(residuals);
  const double whole = scale(magnitude, options.scale_part) + rounding;
  if (!(whole > 0.0)) return {};
  const double reach = threshold(n, options);

  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < n; ++i) {
    if (magnitude[i] <= reach * whole || !is_alone(residuals, i, level[i], options)) continue;
    // Each side by itself: at the edge of a phase one of them is wholly within it.
    const std::span<const double> all = magnitude;
    const auto before = all.subspan(i - std::min(i, options.phase), std::min(i, options.phase));
    const auto after = all.subspan(i + 1, std::min(n - 1 - i, options.phase));
    double local = 0.0;
    for (const auto side : {before, after})
      if (side.size() >= options.phase / 2)
        local = std::max(local, scale(side, options.scale_part));
    if (magnitude[i] > reach * (local + rounding)) found.push_back(i);
  }
  return found;
}

}  // namespace axisfit
