#include "fit/selection/periods.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/linear_algebra.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

/// What the recorded signals show of a force f(t) = exp(i q(t)) on a rigid axis of unit mass that
/// tracks the data by the observer, whitened, in the order of RecordingCost.
Eigen::VectorXcd response(const Recording& recording, const std::vector<std::complex<double>>& f,
                          const Observer& observer) {
  const std::size_t n = recording.times.size();
  std::vector<std::complex<double>> position(n), velocity(n);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    // Implicit midpoint: stable however high the observer gain.
    const double h = recording.times[i + 1] - recording.times[i];
    const std::complex<double> force = 0.5 * (f[i] + f[i + 1]), p = position[i], v = velocity[i];
    const double a = 0.5 * h * observer.position, b = 0.5 * h * observer.velocity,
                 c = 0.5 * h * observer.acceleration;
    const std::complex<double> p0 = (1.0 - a) * p + 0.5 * h * v;
    const std::complex<double> v0 = (1.0 - b) * v - c * p + h * force;
    const double determinant = (1.0 + a) * (1.0 + b) + 0.5 * h * c;
    position[i + 1] = ((1.0 + b) * p0 + 0.5 * h * v0) / determinant;
    velocity[i + 1] = ((1.0 + a) * v0 - c * p0) / determinant;
  }
  std::vector<std::complex<double>> rows;
  for (const Measurement& m : recording.measurements) {
    if (!m.fitted) continue;
    for (std::size_t i = 0; i < n; ++i) {
      if (!recording.fits(m, i)) continue;
      const std::complex<double> x = m.signal == Signal::position       ? position[i]
                                     : m.signal == Signal::acceleration ? f[i]
                                     : m.signal == Signal::velocity     ? velocity[i]
                                                                        : 0.0;
      rows.push_back(x / m.sigma);
    }
  }
  return Eigen::Map<Eigen::VectorXcd>(rows.data(), static_cast<Eigen::Index>(rows.size()));
}

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
  const double shortest = std::max(4.0 * speed * interval, stroke / 400.0);
  if (!(stroke > 0.0) || !(shortest < stroke)) return {};

  struct Line {
    double period, gain;
  };
  std::vector<Line> spectrum;
  const Eigen::VectorXd residual = residuals - basis * (basis.transpose() * residuals);
  const double spacing = 0.25 / stroke;  // 1/m, a quarter of a cycle over the stroke
  for (double wave = 2.0 * spacing; wave < 1.0 / shortest; wave += spacing) {
    if (is_set(stop)) throw Interrupted();
    std::vector<std::complex<double>> force(n);
    for (std::size_t i = 0; i < n; ++i)
      force[i] = std::polar(1.0, 2.0 * std::numbers::pi * wave * simulation.samples[i].position) *
                 (of_drive ? simulation.samples[i].drive_force : 1.0);
    const Eigen::VectorXcd d = response(recording, force, observer);
    Eigen::MatrixXd columns(d.size(), 2);
    columns << d.real(), d.imag();
    columns -= basis * (basis.transpose() * columns);
    const Eigen::Matrix2d gram = columns.transpose() * columns;
    const Eigen::Vector2d right = columns.transpose() * residual;
    const Eigen::Vector2d solution = LeastSquaresSolver(gram).solve(right);
    spectrum.push_back({1.0 / wave, right.dot(solution)});
  }
  std::vector<Line> peaks;
  for (std::size_t i = 0; i < spectrum.size(); ++i) {
    const bool above_left = i == 0 || spectrum[i].gain >= spectrum[i - 1].gain;
    const bool above_right = i + 1 == spectrum.size() || spectrum[i].gain > spectrum[i + 1].gain;
    if (above_left && above_right) peaks.push_back(spectrum[i]);
  }
  std::ranges::sort(peaks, std::greater{}, &Line::gain);
  std::vector<double> periods;
  for (const Line& peak : peaks)
    if (periods.size() < most) periods.push_back(peak.period);
  return periods;
}

}  // namespace axisfit
