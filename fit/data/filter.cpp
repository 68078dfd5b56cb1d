#include "fit/data/filter.h"

#include <numeric>

namespace axisfit {
namespace {

/// Samples after which nothing is left of an impulse, but rounding.
std::size_t memory_of(const Filter& filter) {
  switch (filter.kind) {
    case Filter::Kind::none:
      return 0;
    case Filter::Kind::moving_average:
      return filter.length;
    case Filter::Kind::butterworth:
      break;
  }
  // The slowest pole decays by exp(-2 pi 0.38 cutoff) per sample at the fourth order, faster below.
  return static_cast<std::size_t>(std::ceil(8.0 / filter.cutoff));
}

}  // namespace

std::vector<double> low_pass(std::vector<double> values, double interval, double cutoff) {
  if (values.size() < 2 || cutoff >= 0.49 / interval) return values;
  // Mirrored at both ends, or else the noise of the first and of the last value would count as if
  // it had been there for ever.
  const auto edge = static_cast<std::ptrdiff_t>(
      std::min(static_cast<double>(values.size() - 1), std::ceil(2.0 / (cutoff * interval))));
  std::vector<double> extended(values.rend() - edge - 1, values.rend() - 1);
  extended.insert(extended.end(), values.begin(), values.end());
  extended.insert(extended.end(), values.rbegin() + 1, values.rbegin() + 1 + edge);
  extended = filtered({.kind = Filter::Kind::butterworth,
                       .length = 1,
                       .order = 4,
                       .cutoff = cutoff * interval,
                       .zero_phase = true},
                      std::move(extended));
  std::copy_n(extended.begin() + edge, values.size(), values.begin());
  return values;
}

std::vector<double> impulse_response(const Filter& filter) {
  const std::size_t memory = memory_of(filter);
  // Far enough from the ends for them not to count.
  std::vector<double> impulse(4 * memory + 1, 0.0);
  impulse[2 * memory] = 1.0;
  impulse = filtered(filter, std::move(impulse));
  const auto middle = impulse.begin() + static_cast<std::ptrdiff_t>(2 * memory);
  const auto half = static_cast<std::ptrdiff_t>(memory);
  return {middle - half, middle + half + 1};
}

double delay_of(const Filter& filter) {
  if (filter.zero_phase) return 0.0;
  switch (filter.kind) {
    case Filter::Kind::none:
      break;
    case Filter::Kind::moving_average:
      return 0.5 * static_cast<double>(filter.length - 1);
    case Filter::Kind::butterworth:
      // The sum over the poles, each of which delays by its damping over twice its frequency.
      return 0.5 / (std::tan(std::numbers::pi * filter.cutoff) *
                    std::sin(std::numbers::pi / (2 * filter.order)));
  }
  return 0.0;
}

std::vector<double> advanced(const std::vector<double>& values, double samples) {
  const auto whole = static_cast<std::size_t>(samples);
  const double part = samples - static_cast<double>(whole);
  std::vector<double> earlier(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    earlier[i] = std::lerp(values[std::min(i + whole, values.size() - 1)],
                           values[std::min(i + whole + 1, values.size() - 1)], part);
  return earlier;
}

std::size_t reach_of(const Filter& filter) {
  constexpr double kNegligible = 1e-3;
  const std::vector<double> h = impulse_response(filter);
  const std::size_t memory = h.size() / 2;
  double beyond = 0.0;
  std::size_t reach = memory;
  for (; reach > 0; --reach) {
    beyond += std::abs(h[memory + reach]);
    if (beyond > kNegligible) break;
  }
  return reach;
}

std::vector<double> noise_autocovariance(const Filter& filter, std::size_t stride,
                                         std::size_t count) {
  const std::vector<double> h = impulse_response(filter);
  std::vector<double> covariance(count, 0.0);
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = k * stride; i < h.size(); ++i) covariance[k] += h[i] * h[i - k * stride];
  return covariance;
}

double autocorrelation_time(const Filter& filter) {
  return std::max(1.0, 1.0 / noise_autocovariance(filter, 1, 1)[0]);
}

std::vector<bool> fresh_samples(std::span<const double> values, std::size_t hold) {
  std::vector<bool> fresh(values.size(), false);
  const auto change = std::ranges::adjacent_find(values, std::not_equal_to());
  const auto first = static_cast<std::size_t>(change - values.begin()) + 1;
  for (std::size_t i = first % hold, last = i; i < values.size(); ++i) {
    fresh[i] = i == last || i == last + hold || (i > first && values[i] != values[i - 1]);
    if (fresh[i]) last = i;
  }
  return fresh;
}

std::vector<double> between(std::span<const double> times, std::vector<double> values,
                            const std::vector<bool>& there) {
  std::vector<std::size_t> at;
  for (std::size_t i = 0; i < there.size(); ++i)
    if (there[i]) at.push_back(i);
  if (at.empty()) return values;
  const auto slope = [&](std::size_t k) {
    const std::size_t from = at[k > 0 ? k - 1 : k], to = at[std::min(k + 1, at.size() - 1)];
    return (values[to] - values[from]) / (times[to] - times[from]);
  };
  std::vector<double> curve = values;
  std::fill_n(curve.begin(), at.front(), values[at.front()]);
  std::fill(curve.begin() + static_cast<std::ptrdiff_t>(at.back()) + 1, curve.end(),
            values[at.back()]);
  for (std::size_t k = 0; k + 1 < at.size(); ++k) {
    const std::size_t from = at[k], to = at[k + 1];
    const double length = times[to] - times[from], rise = values[to] - values[from];
    const double begin = slope(k) * length, end = slope(k + 1) * length;
    for (std::size_t i = from + 1; i < to; ++i) {
      const double t = (times[i] - times[from]) / length;
      curve[i] =
          values[from] +
          t * (begin + t * (3.0 * rise - 2.0 * begin - end + t * (begin + end - 2.0 * rise)));
    }
  }
  return curve;
}

std::vector<double> between_fresh(std::vector<double> values, const std::vector<bool>& fresh) {
  std::vector<double> indices(values.size());
  std::iota(indices.begin(), indices.end(), 0.0);
  return between(indices, std::move(values), fresh);
}

}  // namespace axisfit
