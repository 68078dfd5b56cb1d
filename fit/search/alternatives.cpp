#include "fit/search/alternatives.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "fit/solve/solve.h"

namespace axisfit {
namespace {

/// What is left of `change` by the best step along the columns, and that step.
std::pair<double, Eigen::VectorXd> imitated(const Eigen::MatrixXd& columns,
                                            const Eigen::VectorXd& change) {
  const Eigen::VectorXd scale = columns.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns * scale.asDiagonal());
  const Eigen::VectorXd step = scale.cwiseProduct(qr.solve(change));
  return {(change - columns * step).squaredNorm(), step};
}

}  // namespace

std::vector<Alternative> alternatives(const Job& job, const FitResult& fit,
                                      const Candidate& accepted,
                                      const std::vector<Candidate>& candidates) {
  constexpr double kLeft = 0.1;
  constexpr std::size_t kMost = 4;
  const std::vector<double> values = values_of(fit);
  const auto own =
      std::ranges::find(job.free, accepted.strengths.front(), &FreeParameter::quantity);
  if (!fit.at_solution->finite || own == job.free.end()) return {};
  const Eigen::Index place = own - job.free.begin();
  std::vector<Eigen::Index> others(job.free.size() - 1);
  std::iota(others.begin(), others.end(), Eigen::Index{0});
  for (Eigen::Index& k : others) k += k >= place ? 1 : 0;

  const ParameterSpace space(job);
  const double from =
      space.internal(static_cast<std::size_t>(place), values[static_cast<std::size_t>(place)]);
  const double back =
      space.internal(static_cast<std::size_t>(place), accepted.neutral.front()) - from;
  // What takes the correction back; the others have to do it again.
  const Eigen::VectorXd change = back * fit.at_solution->jacobian.col(place);
  const double alone = imitated(fit.at_solution->jacobian(Eigen::all, others), change).first;

  struct Found {
    double left = std::numeric_limits<double>::infinity();  ///< of the change
    Alternative alternative{};
  };
  std::vector<Found> found(candidates.size());
  parallel_for(candidates.size(), [&](std::size_t i) {
    const Candidate& candidate = candidates[i];
    if (candidate.parameters() != 1 || same_effect(candidate, accepted)) return;
    const Job extended =
        with_candidate(job, candidate, values, candidate.neutral, candidate.settings.front());
    const ParameterSpace wider(extended);
    std::vector<double> at = values;
    at.push_back(extended.free.back().initial);
    const Eigen::VectorXd u = wider.internal(at);
    const Linearization linear = linearize(extended, wider, u, fit.observer_gain);
    if (!linear.finite) return;
    std::vector<Eigen::Index> columns = others;
    columns.push_back(u.size() - 1);
    const auto [left, step] = imitated(linear.jacobian(Eigen::all, columns), -change);
    if (!(left < kLeft * alone)) return;
    Alternative alternative{candidate, 0.0, {}};
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto parameter = static_cast<std::size_t>(columns[k]);
      const FreeParameter& free = extended.free[parameter];
      const double moved =
          std::clamp(wider.value(parameter, u[columns[k]] + step[static_cast<Eigen::Index>(k)]),
                     free.lower, free.upper);
      alternative.values.push_back(moved);
    }
    alternative.strength = alternative.values.back();
    alternative.values.pop_back();
    found[i] = {left, std::move(alternative)};
  });
  std::ranges::stable_sort(found, {}, &Found::left);
  std::vector<Alternative> list;
  for (Found& f : found)
    if (std::isfinite(f.left) && list.size() < kMost) list.push_back(std::move(f.alternative));
  return list;
}

}  // namespace axisfit
