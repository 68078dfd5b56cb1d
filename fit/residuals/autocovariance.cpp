#include "fit/residuals/autocovariance.h"

#include <algorithm>
#include <cmath>

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

}  // namespace axisfit
