#include "fit/first_look/force_balance.h"

#include <algorithm>
#include <cmath>

#include "fit/data/derivative.h"
#include "fit/data/noise.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMostWindows = 4000;  // of a recording, which bounds the time
/// Part of a window that may be at rest, where friction has any value.
constexpr double kMostRest = 0.3;
/// Of the highest speed, that counts as rest.
constexpr double kRest = 0.005;
/// Standard deviations of its noise below which a speed has no sign.
constexpr double kSpeedErrors = 3.0;

}  // namespace

Window::Window(std::size_t samples, double interval) {
  const double half = 0.5 * interval * static_cast<double>(samples);
  for (std::size_t i = 0; i <= samples; ++i) {
    const double s = 2.0 * static_cast<double>(i) / static_cast<double>(samples) - 1.0;
    const double r = 1.0 - s * s;
    value.push_back(std::pow(r, 4) * interval);
    slope.push_back(-8.0 * s * std::pow(r, 3) / half * interval);
    bend.push_back((-8.0 * std::pow(r, 3) + 48.0 * s * s * r * r) / (half * half) * interval);
  }
  // Sums over few samples are no integrals: a constant speed and a constant acceleration must
  // come out as they are.
  double area = 0.0, ramp = 0.0, parabola = 0.0, mean = 0.0;
  for (const double x : bend) mean += x / static_cast<double>(bend.size());
  for (std::size_t i = 0; i <= samples; ++i) {
    const double t = half * (2.0 * static_cast<double>(i) / static_cast<double>(samples) - 1.0);
    bend[i] -= mean;
    area += value[i];
    ramp -= slope[i] * t;
    parabola += 0.5 * bend[i] * t * t;
  }
  for (double& x : slope) x *= area / ramp;
  for (double& x : bend) x *= area / parabola;
}

Grid::Grid(const DrivenMotion& motion, bool of_position)
    : motion_(motion), of_position_(of_position) {
  count_ = motion.times.size();
  interval_ = mean_interval(motion.times);
  const std::span<const double> readings = of_position ? motion.position : motion.velocity;
  values_ = on_even_grid(motion.times, readings);
  // What a column says of a motion that it was rounded to is no better than its steps.
  noise_ = std::max(noise_from_differences(readings), resolution_of(readings) / std::sqrt(12.0));
  if (!motion.position.empty()) positions_ = on_even_grid(motion.times, motion.position);
}

std::vector<double> Grid::speeds(std::size_t samples, double& noise) const {
  const auto reach = std::max<std::size_t>(1, samples / 8);
  std::vector<double> speed(count_, 0.0);
  const double width = 2.0 * static_cast<double>(reach) + (of_position_ ? 0.0 : 1.0);
  double sum = 0.0;
  if (of_position_) {
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t a = i - std::min(i, reach), b = std::min(count_ - 1, i + reach);
      speed[i] = (values_[b] - values_[a]) / (static_cast<double>(b - a) * interval_);
    }
    noise = std::sqrt(2.0) * noise_ / (width * interval_);
    return speed;
  }
  for (std::size_t i = 0; i < count_ + reach; ++i) {
    if (i < count_) sum += values_[i];
    if (i > 2 * reach) sum -= values_[i - 2 * reach - 1];
    if (i >= reach)
      speed[i - reach] =
          sum / static_cast<double>(std::min(i, count_ - 1) - (i - std::min(i, 2 * reach)) + 1);
  }
  noise = noise_ / std::sqrt(width);
  return speed;
}

std::vector<double> Grid::input(double delay) const {
  return on_even_grid(motion_.times, motion_.input, delay);
}

std::vector<double> Grid::travels() const {
  std::vector<double> by(count_, 0.0);
  for (std::size_t i = 1; i < count_; ++i)
    by[i] = positions_.empty() ? 0.5 * (values_[i - 1] + values_[i]) * interval_
                               : positions_[i] - positions_[i - 1];
  return by;
}

std::vector<double> Grid::presliding(double travel) const {
  std::vector<double> state = travels();
  double z = 0.0;
  for (double& by : state) {
    const double end = by > 0.0 ? 1.0 : -1.0;
    z = end + (z - end) * std::exp(-std::abs(by) / travel);
    by = z;
  }
  return state;
}

double Grid::stroke() const {
  double at = 0.0, low = 0.0, high = 0.0;
  for (const double by : travels()) {
    at += by;
    low = std::min(low, at);
    high = std::max(high, at);
  }
  return high - low;
}

VectorXd Balance::inputs(const std::vector<Grid>& grids, double delay) const {
  VectorXd result(terms.rows());
  for (const Rows& part : parts) {
    const std::vector<double> input = grids[part.grid].input(delay);
    for (std::size_t k = 0; k < part.first.size(); ++k) {
      double sum = 0.0;
      for (std::size_t i = 0; i < part.window.value.size(); ++i)
        sum += part.window.value[i] * input[part.first[k] + i];
      result[part.row + static_cast<Index>(k)] = sum;
    }
  }
  return result;
}

Balance balance_in(const std::vector<Grid>& grids, std::size_t samples, bool of_position,
                   const FirstLookOptions& options, double delay) {
  Balance balance;
  const bool with_gravity = options.with_gravity;
  const Index terms = with_gravity ? 6 : 4;
  balance.noise = MatrixXd::Zero(terms, terms);
  std::vector<double> rows;  // one after the other
  double speed_samples = 0.0;
  for (std::size_t g = 0; g < grids.size(); ++g) {
    const Grid& grid = grids[g];
    if (grid.count() < kWindowsPerMotion / 2 * samples) continue;
    Balance::Rows part{
        g, {}, static_cast<Index>(rows.size()) / terms, Window(samples, grid.interval()), 0};
    const std::size_t step =
        std::max({std::size_t{1}, samples / kOverlap, (grid.count() - samples) / kMostWindows});
    part.lags = static_cast<Index>(samples / step) * 2;
    double speed_noise = 0.0;
    const std::vector<double> speed = grid.speeds(samples, speed_noise);
    double fastest = 0.0;
    for (const double v : speed) fastest = std::max(fastest, std::abs(v));
    const double least = std::max({kSpeedErrors * speed_noise, kRest * fastest, 1e-300});
    std::vector<double> direction = speed;
    for (double& x : direction) x = std::clamp(x / least, -1.0, 1.0);
    if (options.presliding > 0.0) direction = grid.presliding(options.presliding);
    double bend_square = 0.0, slope_square = 0.0, value_square = 0.0;
    const Window& w = part.window;
    for (std::size_t i = 0; i <= samples; ++i) {
      bend_square += w.bend[i] * w.bend[i];
      slope_square += w.slope[i] * w.slope[i];
      value_square += w.value[i] * w.value[i];
    }
    const double variance = grid.noise() * grid.noise();
    for (std::size_t first = 0; first + samples < grid.count(); first += step) {
      if (static_cast<double>(first) * grid.interval() < delay ||
          static_cast<double>(first + samples) * grid.interval() > grid.duration() + delay)
        continue;
      std::size_t at_rest = 0;
      double mass = 0.0, viscous = 0.0, coulomb = 0.0, constant = 0.0, sine = 0.0, cosine = 0.0;
      const double middle = of_position ? grid.values()[first + samples / 2] : 0.0;
      for (std::size_t i = 0; i <= samples; ++i) {
        const std::size_t at = first + i;
        const double x = grid.values()[at] - middle;
        if (of_position) {
          mass += w.bend[i] * x;
          viscous -= w.slope[i] * x;
        } else {
          mass -= w.slope[i] * x;
          viscous += w.value[i] * x;
        }
        coulomb += w.value[i] * direction[at];
        constant += w.value[i];
        if (with_gravity) {
          sine += w.value[i] * std::sin(grid.positions()[at]);
          cosine += w.value[i] * std::cos(grid.positions()[at]);
        }
        at_rest += std::abs(speed[at]) < least ? 1 : 0;
      }
      if (static_cast<double>(at_rest) > kMostRest * static_cast<double>(samples)) continue;
      part.first.push_back(first);
      for (const double x : {mass, viscous, coulomb, constant}) rows.push_back(x);
      if (with_gravity)
        for (const double x : {sine, cosine}) rows.push_back(x);
      balance.noise(kMass, kMass) += variance * (of_position ? bend_square : slope_square);
      balance.noise(kViscous, kViscous) += variance * (of_position ? slope_square : value_square);
    }
    for (const double v : speed) {
      balance.mean_square_speed += v * v;
      balance.mean_speed += std::abs(v);
    }
    speed_samples += static_cast<double>(speed.size());
    if (!part.first.empty()) balance.parts.push_back(std::move(part));
  }
  balance.mean_square_speed /= std::max(1.0, speed_samples);
  balance.mean_speed /= std::max(1.0, speed_samples);
  balance.terms = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(
      rows.data(), static_cast<Index>(rows.size()) / terms, terms);
  return balance;
}

}  // namespace axisfit
