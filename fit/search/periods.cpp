#include "fit/search/periods.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/linear_algebra.h"
#include "fit/search/force_response.h"
#include "fit/search/options.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

constexpr SearchOptions::Periods kOptions;

}  // namespace

std::vector<double> periods_in(const Recording& recording, const SimulatedRecording& simulation,
                               const Observer& observer, const Eigen::VectorXd& residuals,
                               const Eigen::MatrixXd& basis, std::size_t most, bool of_drive,
                               const StopFlag* stop) {
  const std::size_t n = simulation.samples.size();
  if (n < 16 || n != recording.times.size()) return {};
  double low = INFINITY, high = -INFINITY, speed = 0.0;
  for (const Sample& s : simulation.samples) {
    low = std::min(low, s.position);
    high = std::max(high, s.position);
    speed = std::max(speed, std::abs(s.velocity));
  }
  const double stroke = high - low;
  const double interval = mean_interval(recording.times);
  const double spacing = kOptions.cycle_step / stroke;  // 1/m
  const double shortest = std::max(kOptions.samples_per_period * speed * interval,
                                   static_cast<double>(n) / (spacing * kOptions.most_products));
  if (!(stroke > 0.0) || !(shortest < stroke)) return {};

  struct Line {
    double wave, gain;  // 1/m
  };
  const Eigen::VectorXd residual = residuals - basis * (basis.transpose() * residuals);
  const auto weight = [&](std::size_t i) {
    return of_drive ? simulation.samples[i].drive_force : 1.0;
  };
  const auto unit = [&](double wave, std::size_t i) {
    return std::polar(1.0, 2.0 * std::numbers::pi * wave * simulation.samples[i].position);
  };
  const auto force_of = [&](double wave) {
    std::vector<std::complex<double>> force(n);
    for (std::size_t i = 0; i < n; ++i) force[i] = weight(i) * unit(wave, i);
    return force;
  };
  const auto columns_of = [&](double wave) {
    const Eigen::VectorXcd d =
        response_to<std::complex<double>>(recording, force_of(wave), observer);
    Eigen::MatrixXd columns(d.size(), 2);
    columns << d.real(), d.imag();
    return Eigen::MatrixXd(columns - basis * (basis.transpose() * columns));
  };
  // The product of the residual with the response to a force is that of the force with the
  // response, backwards in time, to the residual: one for all waves. The size of a response changes
  // slowly over the waves, so that a few of them tell.
  const std::vector<double> adjoint = adjoint_response(recording, residual, observer);
  const auto waves = static_cast<std::size_t>(std::ceil((1.0 / shortest) / spacing));
  const std::size_t stride = std::max<std::size_t>(1, waves / kOptions.sizes);
  std::vector<std::complex<double>> turn(n), phase(n);
  for (std::size_t i = 0; i < n; ++i) {
    turn[i] = unit(spacing, i);
    phase[i] =
        adjoint[i] * weight(i) * unit(static_cast<double>(kOptions.first_line - 1) * spacing, i);
  }
  std::vector<Line> spectrum;
  double size = 0.0;
  for (std::size_t k = kOptions.first_line; k < waves; ++k) {
    if (is_set(stop)) throw Interrupted();
    std::complex<double> product = 0.0;
    for (std::size_t i = 0; i < n; ++i) product += phase[i] *= turn[i];
    const double wave = static_cast<double>(k) * spacing;
    if (spectrum.empty() || k % stride == 0) size = 0.5 * columns_of(wave).squaredNorm();
    spectrum.push_back({wave, std::norm(product) / std::max(size, 1e-300)});
  }
  std::vector<Line> peaks;
  for (std::size_t i = 0; i < spectrum.size(); ++i) {
    const bool above_left = i == 0 || spectrum[i].gain >= spectrum[i - 1].gain;
    const bool above_right = i + 1 == spectrum.size() || spectrum[i].gain > spectrum[i + 1].gain;
    if (above_left && above_right) peaks.push_back(spectrum[i]);
  }
  std::ranges::stable_sort(peaks, std::greater{}, &Line::gain);
  // The best of them exactly.
  if (peaks.size() > kOptions.exact * most) peaks.resize(kOptions.exact * most);
  for (Line& peak : peaks) {
    const Eigen::MatrixXd columns = columns_of(peak.wave);
    const Eigen::Vector2d right = columns.transpose() * residual;
    const Eigen::Vector2d solution = LeastSquaresSolver(columns.transpose() * columns).solve(right);
    peak.gain = right.dot(solution);
  }
  std::ranges::stable_sort(peaks, std::greater{}, &Line::gain);
  std::vector<double> periods;
  for (const Line& peak : peaks)
    if (periods.size() < most) periods.push_back(1.0 / peak.wave);
  return periods;
}

}  // namespace axisfit
