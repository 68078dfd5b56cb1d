#include "fit/search/imitators.h"

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

std::vector<Scored> imitators(const Job& job, const FitResult& fit, const Hypothesis& accepted,
                              std::vector<Hypothesis> hypotheses, const SearchOptions& options) {
  const std::vector<double> values = values_of(fit);
  const auto own = std::ranges::find(job.free, accepted.strength(0), &FreeParameter::id);
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
  // The step back to the declared value; the others have to make up for it.
  const Eigen::VectorXd change = back * fit.at_solution->jacobian.col(place);
  const double alone = imitated(fit.at_solution->jacobian(Eigen::all, others), change).first;

  struct Found {
    double left = std::numeric_limits<double>::infinity();  ///< of the change
    Scored start{};
  };
  std::vector<Found> found(hypotheses.size());
  parallel_for(hypotheses.size(), [&](std::size_t i) {
    const Hypothesis& hypothesis = hypotheses[i];
    if (hypothesis.parameters() != 1 || is_same(hypothesis, accepted)) return;
    const Job extended =
        with_hypothesis(job, hypothesis, values, {hypothesis.neutral, hypothesis.settings.front()});
    const ParameterSpace wider(extended);
    std::vector<double> at = values;
    at.push_back(extended.free.back().initial);
    const Eigen::VectorXd u = wider.internal(at);
    const Linearization linear = linearize(extended, wider, u, fit.observer_gain);
    if (!linear.finite) return;
    std::vector<Eigen::Index> columns = others;
    columns.push_back(u.size() - 1);
    const auto [left, step] = imitated(linear.jacobian(Eigen::all, columns), -change);
    if (!(left < options.rivals.imitated * alone)) return;
    Scored start;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto parameter = static_cast<std::size_t>(columns[k]);
      const FreeParameter& free = extended.free[parameter];
      start.others.push_back(
          std::clamp(wider.value(parameter, u[columns[k]] + step[static_cast<Eigen::Index>(k)]),
                     free.lower, free.upper));
    }
    start.own.strengths = {start.others.back()};
    start.others.pop_back();
    found[i] = {left, std::move(start)};
  });
  for (std::size_t i = 0; i < found.size(); ++i)
    found[i].start.hypothesis = std::make_shared<const Hypothesis>(std::move(hypotheses[i]));
  std::ranges::stable_sort(found, {}, &Found::left);
  std::vector<Scored> list;
  for (Found& f : found)
    if (std::isfinite(f.left) && list.size() < options.rivals.constants)
      list.push_back(std::move(f.start));
  return list;
}

}  // namespace axisfit
