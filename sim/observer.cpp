#include "sim/observer.h"

#include <algorithm>

namespace axisfit {

std::vector<double> target_corners(std::span<const double> times, std::span<const double> values) {
  std::vector<double> corners(values.begin(), values.end());
  const std::size_t n = values.size();
  if (n < 3) return corners;
  double curvature = 0.0;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = times[i] - times[i - 1], after = times[i + 1] - times[i];
    const double a = (values[i] - values[i - 1]) / before, b = (values[i + 1] - values[i]) / after;
    curvature = 2.0 * (b - a) / (before + after);
    // What the curve does in a gap is not for the samples beside it to make up for.
    const double longest = 3.0 * std::min(before, after);
    const double h1 = std::min(before, longest), h2 = std::min(after, longest);
    corners[i] -= curvature / 12.0 * (h1 * h1 - h1 * h2 + h2 * h2);
    // An end has one chord, and the curvature of its neighbour.
    if (i == 1) corners[0] -= curvature / 12.0 * h1 * h1;
    if (i + 2 == n) corners[n - 1] -= curvature / 12.0 * h2 * h2;
  }
  return corners;
}

}  // namespace axisfit
