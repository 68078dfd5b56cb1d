#include "fit/data/initial_state.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"

namespace axisfit {
namespace {

constexpr Eigen::Index kOrder = 4;  ///< coefficients of a cubic

/// A cubic through samples.
struct Cubic {
  LocalCourse course;
  double left = 0.0;  ///< standard deviation of what it leaves
};

Cubic cubic_through(const std::vector<double>& times, const std::vector<double>& values,
                    std::size_t first, std::size_t count, std::size_t sample, double noise) {
  const std::size_t end = std::min(first + count, times.size());
  const auto rows = static_cast<Eigen::Index>(end - first);
  if (rows < kOrder) return {{values[sample], 0.0, noise, 0.0}, 0.0};
  const double span = times[end - 1] - times[first];
  Eigen::MatrixXd a(rows, kOrder);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = (times[first + static_cast<std::size_t>(i)] - times[sample]) / span;
    a.row(i) << 1.0, t, t * t, t * t * t;
  }
  const Eigen::Map<const Eigen::VectorXd> b(values.data() + first, rows);
  const Eigen::VectorXd c = LeastSquaresSolver(a).solve(b);
  const Eigen::MatrixXd covariance =
      (a.transpose() * a).ldlt().solve(Eigen::MatrixXd::Identity(kOrder, kOrder));
  const double left =
      rows > kOrder ? (b - a * c).norm() / std::sqrt(static_cast<double>(rows - kOrder)) : 0.0;
  const double error = std::max(noise, left);
  return {{c[0], c[1] / span, error * std::sqrt(covariance(0, 0)),
           error * std::sqrt(covariance(1, 1)) / span},
          left};
}

}  // namespace

LocalCourse local_course(const std::vector<double>& times, const std::vector<double>& values,
                         std::size_t first, std::size_t count, std::size_t sample, double noise) {
  return cubic_through(times, values, first, count, sample, noise).course;
}

LocalCourse first_course(const std::vector<double>& times, const std::vector<double>& values,
                         std::size_t count, double noise) {
  constexpr double kCorner = 2.0;
  constexpr auto kFewest = static_cast<std::size_t>(kOrder);
  for (std::size_t n = std::min(count, times.size()); n > kFewest;
       n -= std::max<std::size_t>(1, n / 4)) {
    const Cubic found = cubic_through(times, values, 0, n, 0, noise);
    if (!(found.left > kCorner * noise)) return found.course;
  }
  if (times.size() < 2) return {values.front(), 0.0, noise, 0.0};
  // The first two alone: nothing tells whether a cubic goes through more.
  const double interval = times[1] - times[0];
  return {values[0], (values[1] - values[0]) / interval, noise, std::sqrt(2.0) * noise / interval};
}

void initial_state_from_data(Recording& recording) {
  const auto is_set = [&](const char* name) {
    return std::ranges::count(recording.overrides, quantity_index(name),
                              [](const auto& o) { return o.first; }) > 0;
  };
  const auto set = [&](const char* name, double value) {
    if (!is_set(name)) recording.overrides.emplace_back(quantity_index(name), value);
  };
  recording.knows_position = is_set("initial.y0");
  recording.knows_velocity = is_set("initial.y1");
  const Measurement* velocity = recording.find(Signal::velocity);
  const std::size_t n = recording.initial_samples;
  if (const Measurement* position = recording.find(Signal::position)) {
    const LocalCourse start = first_course(recording.times, position->values, n, position->sigma);
    set("initial.y0", start.value);
    if (velocity == nullptr) set("initial.y1", start.slope);
  }
  if (velocity != nullptr)
    set("initial.y1", first_course(recording.times, velocity->values, n, velocity->sigma).value);
}

InitialErrors initial_errors(const Recording& recording) {
  InitialErrors errors;
  if (recording.initial_state != InitialState::data) return errors;
  const auto start = [&](const Measurement& m) {
    return first_course(recording.times, m.values, recording.initial_samples, m.sigma);
  };
  if (const Measurement* position = recording.find(Signal::position)) {
    const LocalCourse found = start(*position);
    errors = {found.value_error, found.slope_error};
  }
  if (const Measurement* velocity = recording.find(Signal::velocity))
    errors.velocity = start(*velocity).value_error;
  if (recording.knows_position) errors.position = 0.0;
  if (recording.knows_velocity) errors.velocity = 0.0;
  return errors;
}

}  // namespace axisfit
