// Filtering and repetition of samples by a recorder, before it writes them.
//
// A fit does the same to the simulated samples (residual.cpp), so that measured and simulated ones
// are compared after the same filter. It is linear: applied to dual numbers it filters the
// derivatives too, exactly.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

namespace axisfit {

/// A digital low-pass with gain one for a constant. Defined for evenly sampled signals.
struct Filter {
  enum class Kind { none, moving_average, butterworth };
  Kind kind = Kind::none;
  std::size_t length = 1;  ///< samples of a moving average; odd with zero phase
  int order = 1;           ///< of a Butterworth filter, from 1
  /// Of a Butterworth filter, in cycles per sample, below 0.5: where the amplitude of one pass is
  /// 1 / sqrt(2).
  double cutoff = 0.25;
  /// Without a delay: the average about each sample, or a Butterworth filter forwards and then
  /// backwards, whose amplitude counts twice (1/2 at the cutoff). Otherwise causal.
  bool zero_phase = false;

  bool operator==(const Filter&) const = default;
};

inline constexpr int kHighestFilterOrder = 4;

/// Means over samples i - back to i + ahead; at the ends, over those that exist.
template <class T>
std::vector<T> moving_average(const std::vector<T>& values, std::size_t back, std::size_t ahead) {
  std::vector<T> means;
  means.reserve(values.size());
  T sum(0.0);
  std::size_t from = 0, to = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (; to < std::min(values.size(), i + ahead + 1); ++to) sum += values[to];
    for (; from + back < i; ++from) sum -= values[from];
    means.push_back(sum / static_cast<double>(to - from));
  }
  return means;
}

/// One pass of a Butterworth filter, by the bilinear transform with the cutoff (cycles per sample)
/// where it belongs. Begins as if the first value had been there for ever.
template <class T>
void butterworth_pass(std::vector<T>& values, int order, double cutoff) {
  const double w = std::tan(std::numbers::pi * cutoff);
  if (order % 2 == 1) {
    const double b0 = w / (1.0 + w), a1 = (w - 1.0) / (w + 1.0);
    T state = values.front() * (1.0 - b0);
    for (T& x : values) {
      const T y = b0 * x + state;
      state = b0 * x - a1 * y;
      x = y;
    }
  }
  for (int pair = 0; pair < order / 2; ++pair) {
    const double damping = 2.0 * std::sin((2 * pair + 1) * std::numbers::pi / (2 * order));
    const double norm = 1.0 / (1.0 + w * damping + w * w);
    const double b0 = w * w * norm, b1 = 2.0 * b0;
    const double a1 = 2.0 * (w * w - 1.0) * norm, a2 = (1.0 - w * damping + w * w) * norm;
    T first = values.front() * (1.0 - b0), second = values.front() * (b0 - a2);
    for (T& x : values) {
      const T y = b0 * x + first;
      first = b1 * x - a1 * y + second;
      second = b0 * x - a2 * y;
      x = y;
    }
  }
}

/// The filtered values, as many and at the same instants. Those closer to an end than reach_of()
/// depend on how the filter begins and ends, too.
template <class T>
std::vector<T> filtered(const Filter& filter, std::vector<T> values) {
  if (filter.kind == Filter::Kind::moving_average) {
    const std::size_t ahead = filter.zero_phase ? filter.length / 2 : 0;
    return moving_average(values, filter.length - 1 - ahead, ahead);
  }
  if (filter.kind == Filter::Kind::butterworth && !values.empty()) {
    for (int pass = 0; pass < (filter.zero_phase ? 2 : 1); ++pass) {
      butterworth_pass(values, filter.order, filter.cutoff);
      if (filter.zero_phase) std::ranges::reverse(values);
    }
  }
  return values;
}

/// Butterworth low-pass of the fourth order, run forwards and backwards: no delay, and half power
/// at 0.8 times the cutoff of each run. `interval` in s.
std::vector<double> low_pass(std::vector<double> values, double interval, double cutoff);

/// Response of the filter to a one among zeros: an odd number of values, the middle one at the time
/// of the one.
std::vector<double> impulse_response(const Filter& filter);

/// Delay of a slow signal by the filter, in samples.
double delay_of(const Filter& filter);

/// Shifts values earlier by so many samples, linear between samples; the last value continues.
std::vector<double> advanced(const std::vector<double>& values, double samples);

/// How many samples before the present one still move the filtered value by a thousandth of
/// theirs; with zero phase also after it.
std::size_t reach_of(const Filter& filter);

/// Autocovariance of white noise of variance one after the filter, at lags 0, stride, 2 stride to
/// (count - 1) stride.
std::vector<double> noise_autocovariance(const Filter& filter, std::size_t stride,
                                         std::size_t count);

/// How many samples of filtered white noise carry as much information as one independent sample.
double autocorrelation_time(const Filter& filter);

/// Which samples of a signal are new where each is then repeated, `hold` of them in all: those that
/// differ from the one before, and those `hold` samples after the last new one.
std::vector<bool> fresh_samples(std::span<const double> values, std::size_t hold);

/// Replaces the values that are not `there` by a smooth curve (cubic, by central differences)
/// between those that are, constant at the ends. `times` increase, in any unit.
std::vector<double> between(std::span<const double> times, std::vector<double> values,
                            const std::vector<bool>& there);

/// The same for evenly sampled values, of which the fresh ones are there.
std::vector<double> between_fresh(std::vector<double> values, const std::vector<bool>& fresh);

}  // namespace axisfit
