#include "fit/data/filter_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "fit/data/noise.h"

namespace axisfit {
namespace {

/// The value below which this part of the values lies; reorders them.
double quantile(std::vector<double>& values, double part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(
                                       part * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

/// Correlation at a lag of normal values about zero, by their signs alone, so that a few large ones
/// do not count.
double correlation_of_signs(std::span<const double> values, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = lag; i < values.size(); ++i) {
    const double product = values[i] * values[i - lag];
    sum += double(product > 0.0) - double(product < 0.0);
  }
  return std::sin(0.5 * std::numbers::pi * sum / static_cast<double>(values.size() - lag));
}

/// What differences of the sixth order of samples `stride` apart show: the octave about
/// 0.5 / stride cycles per sample.
struct Octave {
  double scale = 0.0;  ///< standard deviation of the noise there, if it is noise
  bool is_noise = false;

  Octave(std::span<const double> values, std::size_t stride) {
    std::vector<double> d = sixth_differences(values, stride);
    // White noise has -0.86, noise that falls by 12 dB per octave -0.8; a smooth motion nearly 1.
    constexpr double kNoise = -0.5;
    const bool alternates = correlation_of_signs(d, stride) < kNoise;
    for (double& x : d) x = std::abs(x);
    const double middle = quantile(d, 0.5);
    scale = middle / (0.6745 * std::sqrt(924.0));
    // 2.9 for normal values, 1.4 for a tone.
    is_noise = alternates && quantile(d, 0.95) > 2.2 * middle;
  }
};

/// Length of a moving average of white noise: a difference of it is the difference of what enters
/// and what leaves, so that differences so far apart are opposite. Zero where there is none.
std::size_t moving_average_in(std::span<const double> values) {
  const std::vector<double> d = sixth_differences(values, 1);
  constexpr std::size_t kLeast = 7;  // nearer ones overlap
  constexpr double kOpposite = -0.4;  // of -0.5
  const std::size_t most = std::min<std::size_t>(500, d.size() / 8);
  std::size_t length = 0;
  double least = kOpposite;
  for (std::size_t lag = kLeast; lag <= most; ++lag) {
    const double correlation = correlation_of_signs(d, lag);
    if (correlation > least) continue;
    least = correlation;
    length = lag;
  }
  return length;
}

}  // namespace

std::size_t repetition_of(std::span<const double> values) {
  constexpr std::size_t kLeastChanges = 30;
  constexpr double kAlmostAll = 0.98, kBeyondRounding = 1.9;
  std::vector<double> distances, changes;
  for (std::size_t i = 1, last = 0; i < values.size(); ++i) {
    if (values[i] == values[i - 1]) continue;
    if (last > 0) distances.push_back(static_cast<double>(i - last));
    changes.push_back(std::abs(values[i] - values[i - 1]));
    last = i;
  }
  if (distances.size() < kLeastChanges) return 1;
  const double usual = quantile(distances, 0.5);
  const auto multiples =
      std::ranges::count_if(distances, [&](double x) { return std::fmod(x, usual) == 0.0; });
  if (static_cast<double>(multiples) < kAlmostAll * static_cast<double>(distances.size())) return 1;
  if (quantile(changes, 0.5) < kBeyondRounding * resolution_of(values)) return 1;
  return static_cast<std::size_t>(usual);
}

std::optional<SuspectedFilter> suspected_filter(std::span<const double> values) {
  constexpr std::size_t kLeastValues = 500;
  if (values.size() < kLeastValues) return std::nullopt;
  // By how much the noise has to rise from each octave to the next lower one: what a gear that
  // rings after every reversal adds is more in the lower ones.
  constexpr struct {
    std::size_t stride;
    double rise;
  } kOctaves[]{{1, 1.3}, {2, 2.0}, {4, 3.0}};
  const std::size_t average = moving_average_in(values);
  constexpr double kRiseOfAverage = 1.15;  // of 1.41: that it is one says more
  const double scatter = 5.0 / std::sqrt(static_cast<double>(values.size()));
  const double resolution = resolution_of(values);
  for (const auto& [stride, rise] : kOctaves) {
    const Octave high(values, stride);
    // Rounding is white only where the noise makes it so.
    if (!(high.scale > 0.5 * resolution)) continue;
    Octave low(values, 2 * stride);
    const double least = average > 0 && stride == 1 ? kRiseOfAverage : rise + scatter;
    if (!low.is_noise || low.scale < least * high.scale) continue;
    if (average > 0) return SuspectedFilter{0.44 / static_cast<double>(average), average};
    std::size_t passes = 2 * stride;
    for (constexpr double kStillRises = 1.25; 16 * passes < values.size(); passes *= 2) {
      const Octave next(values, 2 * passes);
      if (!next.is_noise || next.scale < kStillRises * low.scale) break;
      low = next;
    }
    return SuspectedFilter{0.5 / static_cast<double>(passes)};
  }
  return std::nullopt;
}

}  // namespace axisfit
