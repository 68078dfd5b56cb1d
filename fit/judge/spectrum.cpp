#include "fit/judge/spectrum.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <unsupported/Eigen/FFT>

#include "base/linear_algebra.h"

namespace axisfit {
namespace {

constexpr std::size_t kMinSamples = 32;
constexpr double kTurn = 2.0 * std::numbers::pi;

/// Power over frequency, as means over half overlapping segments of n values under a Hann window.
Spectrum mean_spectrum(std::span<const double> values, double interval, std::size_t n) {
  Spectrum spectrum;
  if (values.size() < kMinSamples) return spectrum;
  const std::size_t padded = std::bit_ceil(n);  // with zeros
  std::vector<double> window(n), segment(padded);
  for (std::size_t i = 0; i < n; ++i)
    window[i] = std::pow(std::sin(std::numbers::pi * double(i) / double(n)), 2);
  const double weight = std::inner_product(window.begin(), window.end(), window.begin(), 0.0);
  spectrum.size.assign(padded / 2, 0.0);
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> transform;
  double segments = 0.0;
  for (std::size_t first = 0; first + n <= values.size(); first += n / 2, ++segments) {
    for (std::size_t i = 0; i < n; ++i) segment[i] = window[i] * values[first + i];
    fft.fwd(transform, segment);
    for (std::size_t k = 0; k < padded / 2; ++k)
      spectrum.size[k] += std::norm(transform[k + 1]) / weight;
  }
  for (std::size_t k = 0; k < padded / 2; ++k) {
    spectrum.size[k] /= segments;
    spectrum.wave.push_back(double(k + 1) / (double(padded) * interval));
  }
  return spectrum;
}

}  // namespace

std::vector<double> autocorrelation(std::span<const double> values, std::size_t lags) {
  std::vector<double> result;
  for (std::size_t lag = 0; lag <= lags; ++lag)
    result.push_back(std::inner_product(values.begin() + static_cast<std::ptrdiff_t>(lag),
                                        values.end(), values.begin(), 0.0));
  const double variance = result.front();
  for (double& r : result) r = variance > 0.0 ? r / variance : 0.0;
  return result;
}

Spectrum power_spectrum(std::span<const double> values, double interval) {
  return mean_spectrum(values, interval, std::bit_floor(values.size() / 4));
}

Spectrum periodogram(std::span<const double> values, double interval) {
  return mean_spectrum(values, interval, values.size());
}

Spectrum spatial_spectrum(std::span<const double> values, std::span<const double> positions,
                          int cycles) {
  Spectrum spectrum;
  const auto n = static_cast<Eigen::Index>(values.size());
  if (values.size() < kMinSamples) return spectrum;
  const auto [low, high] = std::ranges::minmax(positions);
  const double stroke = high - low;
  if (!(stroke > 0.0)) return spectrum;
  const Eigen::Map<const Eigen::ArrayXd> y(values.data(), n), x(positions.data(), n);
  for (int quarter = 2; quarter <= 4 * cycles; ++quarter) {
    const double wave = 0.25 * quarter / stroke;
    const Eigen::ArrayXd phase = kTurn * wave * (x - low);
    Eigen::MatrixX3d columns(n, 3);
    columns << phase.cos(), phase.sin(), Eigen::ArrayXd::Ones(n);
    const Eigen::Vector3d fitted =
        LeastSquaresSolver(columns.transpose() * columns).solve(columns.transpose() * y.matrix());
    spectrum.wave.push_back(wave);
    spectrum.size.push_back(std::hypot(fitted[0], fitted[1]));
  }
  return spectrum;
}

}  // namespace axisfit
