#include "fit/data/derivative.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fit/data/filter.h"
#include "fit/data/noise.h"
#include "sim/sampling.h"

namespace axisfit {

std::vector<double> on_even_grid(std::span<const double> times, std::span<const double> values,
                                 double delay) {
  const double interval = mean_interval(times);
  std::vector<double> even;
  even.reserve(values.size());
  std::size_t k = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = times.front() + static_cast<double>(i) * interval - delay;
    while (k + 2 < values.size() && times[k + 1] < t) ++k;
    const double share = std::clamp((t - times[k]) / (times[k + 1] - times[k]), 0.0, 1.0);
    even.push_back(values[k] + share * (values[k + 1] - values[k]));
  }
  return even;
}

std::vector<double> central_differences(const std::vector<double>& values, double interval) {
  std::vector<double> rates(values.size(), 0.0);
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    rates[i] = (values[i + 1] - values[i - 1]) / (2.0 * interval);
  return rates;
}

double noise_gain(int derivatives, double cutoff, double interval) {
  const double bands = 2.0 * cutoff * interval;  // of the noise that pass
  return std::pow(2.0 * std::numbers::pi * cutoff, derivatives) *
         std::sqrt(bands / (2.0 * derivatives + 1.0));
}

std::vector<double> derivative(const std::vector<double>& values, double interval, int order) {
  constexpr double kHighest = 40.0, kLowest = 1.0, kNoise = 0.03;
  const double noise = noise_from_differences(values);
  std::vector<double> rates;
  for (double cutoff = std::min(kHighest, 0.1 / interval);; cutoff *= 0.5) {
    rates = low_pass(values, interval, cutoff);
    for (int i = 0; i < order; ++i) rates = central_differences(rates, interval);
    double squares = 0.0;
    for (const double x : rates) squares += x * x;
    if (noise * noise_gain(order, cutoff, interval) <=
            kNoise * std::sqrt(squares / static_cast<double>(rates.size())) ||
        cutoff <= 2.0 * kLowest)
      return rates;
  }
}

}  // namespace axisfit
