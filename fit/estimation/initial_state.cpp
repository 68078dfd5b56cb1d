#include "fit/estimation/initial_state.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"

namespace axisfit {
namespace {

/// Value and slope of a signal at the first sample, and their standard errors.
struct Start {
  double value = 0.0, slope = 0.0;
  double value_error = 0.0, slope_error = 0.0;
};

/// Of a cubic through the first n samples. What it leaves of them, or the stated noise where that
/// is more, makes the errors.
Start start_of(const std::vector<double>& times, const std::vector<double>& values, std::size_t n,
               double noise = 0.0) {
  constexpr Eigen::Index kOrder = 4;
  const auto rows = static_cast<Eigen::Index>(std::min(n, times.size()));
  if (rows < kOrder) return {values.front(), 0.0, noise, 0.0};
  const double span = times[static_cast<std::size_t>(rows - 1)] - times.front();
  Eigen::MatrixXd a(rows, kOrder);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = (times[static_cast<std::size_t>(i)] - times.front()) / span;
    a.row(i) << 1.0, t, t * t, t * t * t;
  }
  const Eigen::Map<const Eigen::VectorXd> b(values.data(), rows);
  const Eigen::VectorXd c = LeastSquaresSolver(a).solve(b);
  const Eigen::MatrixXd covariance =
      (a.transpose() * a).ldlt().solve(Eigen::MatrixXd::Identity(kOrder, kOrder));
  const double left = std::max(
      noise,
      rows > kOrder ? (b - a * c).norm() / std::sqrt(static_cast<double>(rows - kOrder)) : 0.0);
  return {c[0], c[1] / span, left * std::sqrt(covariance(0, 0)),
          left * std::sqrt(covariance(1, 1)) / span};
}

}  // namespace

void initial_state_from_data(Recording& recording) {
  const auto set = [&](const char* name, double value) {
    const std::size_t index = find_quantity(name)->index;
    const bool given =
        std::ranges::any_of(recording.overrides, [&](const auto& o) { return o.first == index; });
    if (!given) recording.overrides.emplace_back(index, value);
  };
  const Measurement* velocity = recording.find(Signal::velocity);
  const std::size_t n = recording.initial_samples;
  if (const Measurement* position = recording.find(Signal::position)) {
    const Start start = start_of(recording.times, position->values, n);
    set("initial.y0", start.value);
    if (velocity == nullptr) set("initial.y1", start.slope);
  }
  if (velocity != nullptr) set("initial.y1", start_of(recording.times, velocity->values, n).value);
}

InitialErrors initial_errors(const Recording& recording) {
  InitialErrors errors;
  if (recording.initial_state != InitialState::data) return errors;
  const auto start = [&](const Measurement& m) {
    return start_of(recording.times, m.values, recording.initial_samples, m.sigma);
  };
  if (const Measurement* position = recording.find(Signal::position)) {
    const Start found = start(*position);
    errors = {found.value_error, found.slope_error};
  }
  if (const Measurement* velocity = recording.find(Signal::velocity))
    errors.velocity = start(*velocity).value_error;
  return errors;
}

}  // namespace axisfit
