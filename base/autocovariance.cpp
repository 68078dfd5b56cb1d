#include "base/autocovariance.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/convolution.h"

namespace axisfit {

std::vector<double> autocovariance(std::span<const double> values, std::size_t most) {
  std::vector<double> covariance(most + 1, 0.0);
  for (std::size_t lag = 0; lag <= most; ++lag) {
    for (std::size_t i = lag; i < values.size(); ++i)
      covariance[lag] += values[i] * values[i - lag];
    covariance[lag] /= static_cast<double>(std::max<std::size_t>(1, values.size()));
  }
  return covariance;
}

Autoregression fit_autoregression(std::span<const double> covariance, double samples) {
  Autoregression best{{}, covariance[0]};
  if (!(covariance[0] > 0.0)) return best;
  std::vector<double> a;
  double innovation = covariance[0];
  double least = samples * std::log(innovation);
  for (std::size_t order = 1; order < covariance.size(); ++order) {
    double partial = covariance[order];
    for (std::size_t i = 0; i + 1 < order; ++i) partial -= a[i] * covariance[order - 1 - i];
    partial /= innovation;
    std::vector<double> next = a;
    for (std::size_t i = 0; i + 1 < order; ++i) next[i] -= partial * a[order - 2 - i];
    next.push_back(partial);
    a = std::move(next);
    innovation *= 1.0 - partial * partial;
    if (!(innovation > 1e-12 * covariance[0])) break;
    const double criterion =
        samples * std::log(innovation) + static_cast<double>(order) * std::log(samples);
    if (criterion < least) {
      least = criterion;
      best = {a, innovation};
    }
  }
  return best;
}

std::vector<double> modelled_autocovariance(std::span<const double> values) {
  const std::size_t n = values.size();
  // Few samples show a colour by chance too often.
  constexpr std::size_t kMinSamples = 50;
  std::vector<double> covariance =
      autocovariance(values, n < kMinSamples ? 0 : std::min<std::size_t>(40, n / 10));
  if (!(covariance[0] > 0.0)) return {0.0};
  const std::vector<double> chosen =
      fit_autoregression(covariance, static_cast<double>(n)).coefficients;

  covariance.resize(chosen.size() + 1);
  if (chosen.empty()) return covariance;
  constexpr double kDiedAway = 1e-3;
  double recent = covariance[0];  // an upper bound of the last few magnitudes
  while (recent > kDiedAway * covariance[0] && covariance.size() < n) {
    double next = 0.0;
    for (std::size_t i = 0; i < chosen.size(); ++i)
      next += chosen[i] * covariance[covariance.size() - 1 - i];
    covariance.push_back(next);
    recent = std::max(0.98 * recent, std::abs(next));
  }
  return covariance;
}

double mean_square(std::span<const double> values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
         static_cast<double>(std::max<std::size_t>(1, values.size()));
}

double autocorrelation_time(std::span<const double> values) {
  const std::size_t n = values.size();
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) /
                      static_cast<double>(std::max<std::size_t>(1, n));
  std::vector<double> centred(values.begin(), values.end());
  for (double& x : centred) x -= mean;
  // Of a white residual, a few lags are enough.
  constexpr std::size_t kDirect = 16;
  std::vector<double> all;
  const auto covariance = [&](std::size_t lag) {
    if (lag < kDirect)
      return std::inner_product(centred.begin() + static_cast<std::ptrdiff_t>(lag), centred.end(),
                                centred.begin(), 0.0);
    if (all.empty()) all = lagged_products(centred);
    return all[lag];
  };
  const double variance = covariance(0);
  if (!(variance > 0.0)) return 1.0;
  double time = 1.0;
  double previous = covariance(1);
  for (std::size_t lag = 1; lag + 1 < n / 4; lag += 2) {
    const double next = covariance(lag + 1);
    if (previous + next <= 0.0) break;
    time += 2.0 * (previous + next) / variance;
    previous = covariance(lag + 2);
  }
  return std::max(1.0, time);
}

double variance_along(std::span<const double> change, std::span<const double> residual) {
  const std::size_t n = residual.size();
  const std::vector<double> c = lagged_products({change.begin(), change.end()}),
                            r = lagged_products({residual.begin(), residual.end()});
  if (!(c[0] > 0.0)) return mean_square(residual) * autocorrelation_time(residual);
  // A wide band has little scatter, a narrow one follows the peak of a drift: the larger counts.
  constexpr std::size_t kLeastLags = 32, kParts[] = {8, 32};
  double largest = 0.0;
  for (const std::size_t part : kParts) {
    const std::size_t lags = std::min(n - 1, std::max(kLeastLags, n / part));
    double sum = c[0] * r[0];
    for (std::size_t lag = 1; lag <= lags; ++lag) {
      const double x = static_cast<double>(lag) / static_cast<double>(lags);
      const double parzen = x < 0.5 ? 1.0 - 6.0 * x * x * (1.0 - x) : 2.0 * std::pow(1.0 - x, 3);
      sum += 2.0 * parzen * c[lag] * r[lag];
    }
    largest = std::max(largest, sum);
  }
  return largest / (c[0] * static_cast<double>(n));
}

}  // namespace axisfit
