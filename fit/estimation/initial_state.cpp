#include "fit/estimation/initial_state.h"

#include <algorithm>

#include "base/linear_algebra.h"

namespace axisfit {
namespace {

/// Value and slope at the first sample of a cubic through the first n samples.
std::pair<double, double> start_of(const std::vector<double>& times,
                                   const std::vector<double>& values, std::size_t n) {
  constexpr Eigen::Index kOrder = 4;
  const auto rows = static_cast<Eigen::Index>(std::min(n, times.size()));
  if (rows < kOrder) return {values.front(), 0.0};
  const double span = times[static_cast<std::size_t>(rows - 1)] - times.front();
  Eigen::MatrixXd a(rows, kOrder);
  Eigen::VectorXd b(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = (times[static_cast<std::size_t>(i)] - times.front()) / span;
    a.row(i) << 1.0, t, t * t, t * t * t;
    b[i] = values[static_cast<std::size_t>(i)];
  }
  const Eigen::VectorXd c = LeastSquaresSolver(a).solve(b);
  return {c[0], c[1] / span};
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
    const auto [y0, y1] = start_of(recording.times, position->values, n);
    set("initial.y0", y0);
    if (velocity == nullptr) set("initial.y1", y1);
  }
  if (velocity != nullptr) set("initial.y1", start_of(recording.times, velocity->values, n).first);
}

}  // namespace axisfit
