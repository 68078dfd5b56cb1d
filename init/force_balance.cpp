#include "init/force_balance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "base/linear_algebra.h"

namespace axisfit {
namespace {

/// Stretches of which each has its impulse: short beside the motion, long beside noise.
constexpr std::size_t kStretches = 200;

}  // namespace

std::optional<ForceBalance> force_balance(std::span<const double> times,
                                          std::span<const double> position,
                                          std::span<const double> velocity,
                                          std::span<const double> force, bool with_gravity) {
  const std::size_t n = times.size(), term_count = with_gravity ? 6 : 4;
  const std::size_t stretches = std::min(kStretches, n / 8);
  if (stretches < 4 * term_count || (with_gravity && position.empty()) ||
      (position.empty() && velocity.empty()))
    return std::nullopt;
  // A constant alone would balance one that never changes.
  if (std::ranges::adjacent_find(force, std::not_equal_to<>()) == force.end()) return std::nullopt;
  std::vector<double> way(n, 0.0), impulse(n, 0.0), sine(n, 0.0), cosine(n, 0.0);
  for (std::size_t i = 1; i < n; ++i) {
    const double dt = times[i] - times[i - 1];
    impulse[i] = impulse[i - 1] + force[i - 1] * dt;
    if (with_gravity) {
      sine[i] = sine[i - 1] + std::sin(position[i - 1]) * dt;
      cosine[i] = cosine[i - 1] + std::cos(position[i - 1]) * dt;
    }
    way[i] = position.empty() ? way[i - 1] + 0.5 * (velocity[i] + velocity[i - 1]) * dt
                              : position[i] - position[0];
  }
  // Mean speeds of neighbouring stretches differ by the mean acceleration from centre to centre;
  // the force is that of the two.
  const auto rows = static_cast<Eigen::Index>(stretches - 1);
  Eigen::MatrixXd terms(rows, static_cast<Eigen::Index>(term_count));
  Eigen::VectorXd impulses(rows);
  for (std::size_t k = 0; k + 1 < stretches; ++k) {
    const std::size_t a = k * (n - 1) / stretches, b = (k + 1) * (n - 1) / stretches,
                      c = (k + 2) * (n - 1) / stretches;
    const double first = (way[b] - way[a]) / (times[b] - times[a]);
    const double second = (way[c] - way[b]) / (times[c] - times[b]);
    const double dt = 0.5 * (times[c] - times[a]);
    const double mean = 0.5 * (first + second);
    const auto row = static_cast<Eigen::Index>(k);
    terms.row(row).head<4>() << second - first, mean * dt,
        (mean > 0.0   ? 1.0
         : mean < 0.0 ? -1.0
                      : 0.0) *
            dt,
        dt;
    if (with_gravity)
      terms.row(row).tail<2>() << 0.5 * (sine[c] - sine[a]), 0.5 * (cosine[c] - cosine[a]);
    impulses[row] = 0.5 * (impulse[c] - impulse[a]);
  }
  Eigen::VectorXd size = terms.colwise().norm();
  if (!(size.minCoeff() > 0.0) || !(impulses.norm() > 0.0)) return std::nullopt;
  const Eigen::MatrixXd scaled = terms * size.cwiseInverse().asDiagonal();
  const LeastSquaresSolver solver(scaled, 1e-6);
  if (solver.rank() < static_cast<Eigen::Index>(term_count)) return std::nullopt;
  const Eigen::VectorXd scaled_terms = solver.solve(impulses);
  const Eigen::VectorXd found = scaled_terms.cwiseQuotient(size);
  ForceBalance balance{found[0], found[1], found[2], found[3]};
  if (with_gravity) {
    balance.gravity_sine = found[4];
    balance.gravity_cosine = found[5];
  }
  const double explained = (scaled * scaled_terms).norm() / impulses.norm();
  balance.correlation = std::copysign(std::min(1.0, explained), balance.mass);
  return balance;
}

}  // namespace axisfit
