#include "fit/data/standstill.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace axisfit {

std::vector<bool> at_standstill(const Recording& recording) {
  constexpr std::size_t kHalf = 12, kWidth = 2 * kHalf + 1;
  const std::size_t n = recording.times.size();
  const Measurement* velocity = recording.find(Signal::velocity);
  const Measurement* position = recording.find(Signal::position);
  if ((velocity == nullptr && position == nullptr) || n < 2 * kWidth) return {};
  // Where a window of samples around each one stays within four standard errors of rest. A
  // position may also move by the two steps of its noise that a window can show.
  std::vector<bool> still(n, false);
  if (velocity != nullptr) {
    const double correlated =
        noise_correlation_time(*velocity) * static_cast<double>(velocity->hold);
    const double limit =
        4.0 * velocity->sigma * std::sqrt(std::min(1.0, correlated / double(kWidth)));
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      sum += velocity->values[i];
      if (i >= kWidth) sum -= velocity->values[i - kWidth];
      if (i + 1 >= kWidth) still[i - kHalf] = std::abs(sum / double(kWidth)) < limit;
    }
  } else {
    for (std::size_t i = kHalf; i + kHalf < n; ++i) {
      const auto [low, high] =
          std::ranges::minmax(std::span(position->values).subspan(i - kHalf, kWidth));
      still[i] = high - low < 8.0 * position->sigma;
    }
  }
  // The ends follow their neighbours: a standstill lasts longer than a window.
  for (std::size_t i = 0; i < kHalf; ++i) {
    still[i] = still[kHalf];
    still[n - 1 - i] = still[n - 1 - kHalf];
  }
  for (auto begin = std::ranges::find(still, true); begin != still.end();
       begin = std::find(begin, still.end(), true)) {
    const auto end = std::find(begin, still.end(), false);
    if (end - begin < static_cast<std::ptrdiff_t>(2 * kWidth)) std::fill(begin, end, false);
    begin = end;
  }
  return still;
}

double noise_at_standstill(const Recording& recording, const Measurement& measurement) {
  const std::vector<bool> standstill = at_standstill(recording);
  double sum = 0.0, degrees_of_freedom = 0.0;
  for (auto begin = std::ranges::find(standstill, true); begin != standstill.end();) {
    const auto end = std::find(begin, standstill.end(), false);
    const std::span values = std::span(measurement.values)
                                 .subspan(static_cast<std::size_t>(begin - standstill.begin()),
                                          static_cast<std::size_t>(end - begin));
    const double n = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    for (const double x : values) sum += (x - mean) * (x - mean);
    degrees_of_freedom += n - 1.0;
    begin = std::find(end, standstill.end(), true);
  }
  return degrees_of_freedom > 0.0 ? std::sqrt(sum / degrees_of_freedom) : 0.0;
}

void exclude_acceleration_at_standstill(Recording& recording) {
  const std::vector<bool> standstill = at_standstill(recording);
  for (Measurement& m : recording.measurements)
    if (m.signal == Signal::acceleration) m.excluded = standstill;
}

std::optional<ExcludedSamples> excluded_samples(const Measurement& measurement) {
  ExcludedSamples excluded;
  for (std::size_t i = 0; i < measurement.excluded.size(); ++i) {
    if (!measurement.excluded[i]) continue;
    ++excluded.samples;
    excluded.mean += measurement.values[i];
  }
  if (excluded.samples == 0) return std::nullopt;
  const double n = static_cast<double>(excluded.samples);
  excluded.mean /= n;
  excluded.is_within_noise = std::abs(excluded.mean) < 4.0 * measurement.sigma / std::sqrt(n);
  return excluded;
}

}  // namespace axisfit
