#include "fit/search/exchange_score.h"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"
#include "fit/solve/parameters.h"
#include "fit/solve/solve.h"

namespace axisfit {
namespace {

using Eigen::Index;

bool is_free_in(const Job& job, ParameterId id) {
  return std::ranges::find(job.free, id, &FreeParameter::id) != job.free.end();
}

bool is_absent_nearby(const Hypothesis& hypothesis) {
  return hypothesis.kind != HypothesisKind::transmission &&
         std::ranges::all_of(hypothesis.neutral, [](double x) { return std::isfinite(x); });
}

/// The steps of the free parameters, in the units of the space, that make these absent.
Eigen::VectorXd steps_to_absence(const Job& job, const ParameterSpace& space,
                                 const Eigen::VectorXd& u,
                                 const std::vector<Hypothesis>& taken_out) {
  Eigen::VectorXd steps = Eigen::VectorXd::Zero(u.size());
  for (const Hypothesis& one : taken_out)
    for (std::size_t s = 0; s < one.strengths.size(); ++s) {
      const auto found = std::ranges::find(job.free, one.strength(s), &FreeParameter::id);
      const auto place = static_cast<std::size_t>(found - job.free.begin());
      const auto i = static_cast<Index>(place);
      steps[i] = space.internal(place, one.neutral[s]) - u[i];
    }
  return steps;
}

}  // namespace

bool is_out_of_reach(const ExchangeScore& score, const SearchOptions& options) {
  return score.with_rival > std::max(options.rivals.far * clear_difference(options),
                                     options.rivals.left * score.with_nothing);
}

std::optional<ExchangeScore> exchange_score(const FittedModel& present,
                                            const std::vector<Accepted>& accepted,
                                            const Job& others, const Scored& rival) {
  const Hypothesis& hypothesis = *rival.hypothesis;
  std::vector<Hypothesis> taken_out;
  for (const Accepted& one : accepted)
    if (!is_free_in(others, one.hypothesis.strength(0))) taken_out.push_back(one.hypothesis);
  // Without the whole its parts do nothing.
  const std::vector<Hypothesis> wholes = taken_out;
  std::erase_if(taken_out, [&](const Hypothesis& part) {
    return std::ranges::any_of(wholes,
                               [&](const Hypothesis& whole) { return is_part_of(part, whole); });
  });
  if (!is_absent_nearby(hypothesis) || !hypothesis.probes.empty() ||
      !std::ranges::all_of(taken_out, is_absent_nearby))
    return std::nullopt;
  std::vector<double> values = values_of(present.fit);
  const Job both = with_hypothesis(present.job, hypothesis, values,
                                   {hypothesis.neutral, rival.own.shapes}, true);
  values.insert(values.end(), hypothesis.neutral.begin(), hypothesis.neutral.end());
  const ParameterSpace space(both);
  const Eigen::VectorXd u = space.internal(values);
  const Linearization at = linearize(both, space, u, present.fit.observer_gain);
  if (!at.finite) return std::nullopt;

  const auto own = static_cast<Index>(hypothesis.strengths.size());
  Eigen::MatrixXd columns(at.jacobian.rows(), static_cast<Index>(others.free.size()) + own);
  Index kept = 0;
  for (Index i = 0; i < at.jacobian.cols() - own; ++i)
    if (is_free_in(others, both.free[static_cast<std::size_t>(i)].id()))
      columns.col(kept++) = at.jacobian.col(i);
  columns.middleCols(kept, own) = at.jacobian.rightCols(own);
  for (auto column : columns.leftCols(kept + own).colwise())
    if (const double length = column.norm(); length > 0.0) column /= length;

  const Eigen::VectorXd absent =
      at.residuals + at.jacobian * steps_to_absence(both, space, u, taken_out);
  const auto left_by = [&](Index count) {
    if (count == 0) return absent.squaredNorm();
    const Eigen::MatrixXd used = columns.leftCols(count);
    return (absent - used * LeastSquaresSolver(used).solve(absent)).squaredNorm();
  };
  const double now = at.residuals.squaredNorm(),
               unit = std::max(1.0, now / static_cast<double>(at.residuals.size()));
  return ExchangeScore{(left_by(kept + own) - now) / unit, (left_by(kept) - now) / unit};
}

}  // namespace axisfit
