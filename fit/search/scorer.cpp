#include "fit/search/scorer.h"

#include <algorithm>
#include <cmath>

#include "fit/estimate/recipes.h"

namespace axisfit {
namespace {

using Eigen::Index;

/// Orthonormal columns that span those of a matrix; a column of zeros where they span nothing, for
/// of a matrix without columns Eigen takes no blocks.
Eigen::MatrixXd basis_of(const Eigen::MatrixXd& a) {
  const Eigen::MatrixXd nothing = Eigen::MatrixXd::Zero(a.rows(), 1);
  if (a.cols() == 0) return nothing;
  Eigen::MatrixXd scaled = a;
  for (Index k = 0; k < a.cols(); ++k)
    if (const double length = a.col(k).norm(); length > 0.0) scaled.col(k) /= length;
  const LeastSquaresSolver solver(scaled, 1e-9);
  return solver.rank() == 0 ? nothing : solver.basis();
}

/// Where a step takes a strength.
double moved_by(const Hypothesis& hypothesis, double value, double step) {
  if (std::isinf(value)) return 1.0 / step;
  const QuantityEntry& entry = quantity_list()[hypothesis.strengths.front()];
  const bool is_logarithmic =
      hypothesis.kind == HypothesisKind::constant && scale_of(entry, value) == Scale::logarithmic;
  return is_logarithmic ? value * std::exp(step) : value + step;
}

/// Candidates have no part in what is known of the free parameters: the rows of priors are zero.
Eigen::MatrixXd with_priors(const Eigen::MatrixXd& derivatives, Index rows) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows, derivatives.cols());
  all.topRows(derivatives.rows()) = derivatives;
  return all;
}

}  // namespace

Job with_coarse_steps(Job job) {
  job.options = recipe::coarse(job.options);
  return job;
}

SolveResult tracking_fit(const Job& job, const ParameterSpace& space,
                         const std::vector<double>& values, double observer_gain,
                         const SearchContext& context) {
  SolveOptions options;
  options.max_iterations = context.options.scoring.tracking_iterations;
  options.function_tolerance = context.options.scoring.tracking_tolerance;
  return solve(job, space, space.internal(values), observer_gain, options, context.run);
}

std::optional<ScorePoint> score_point(const Job& job, const std::vector<double>& values,
                                      double observer_gain, const SearchContext& context) {
  const ParameterSpace space(job);
  const SolveResult tracking = tracking_fit(job, space, values, observer_gain, context);
  if (!tracking.usable) return std::nullopt;
  ScorePoint point;
  point.u = tracking.u;
  point.values = space.values(tracking.u);
  point.base = linearize(job, space, tracking, observer_gain);
  if (!point.base.finite) return std::nullopt;
  point.basis = basis_of(point.base.jacobian);
  const Eigen::VectorXd& r = point.base.residuals;
  point.residuals = r - point.basis * (point.basis.transpose() * r);
  if (!std::isfinite(point.residuals.squaredNorm())) return std::nullopt;  // squares may overflow
  return point;
}

std::optional<ScoreStep> Scorer::step(std::span<const EffectSetting> settings,
                                      std::span<const Eigen::MatrixXd> derivatives,
                                      double least_gain) const {
  const Eigen::VectorXd& residuals = point_.residuals;
  Eigen::MatrixXd whole(residuals.size(), 0), columns(residuals.size(), 0);
  for (const Eigen::MatrixXd& own : derivatives) {
    if (own.size() == 0) return std::nullopt;
    const Eigen::MatrixXd left = projected(own);
    if (left.size() == 0) return std::nullopt;
    whole.conservativeResize(Eigen::NoChange, whole.cols() + own.cols());
    whole.rightCols(own.cols()) = with_priors(own, residuals.size());
    columns.conservativeResize(Eigen::NoChange, columns.cols() + left.cols());
    columns.rightCols(left.cols()) = left;
  }
  const Eigen::VectorXd way = LeastSquaresSolver(columns).solve(-residuals);
  if (!way.allFinite()) return std::nullopt;
  ScoreStep result;
  Index next = 0;
  for (const EffectSetting& setting : settings) {
    const std::vector<double>& strengths = setting.own.strengths;
    HypothesisValues& reached = result.own.emplace_back();
    reached.shapes = setting.own.shapes;
    for (std::size_t k = 0; k < strengths.size(); ++k) {
      const Quantity& q = job_.entry(setting.hypothesis->strengths[k]).quantity;
      const double moved = moved_by(*setting.hypothesis, strengths[k], way[next++]);
      reached.strengths.push_back(moved);
      if (strengths.size() == 1 && (moved < q.lower || moved > q.upper)) return std::nullopt;
    }
  }
  result.change = columns * way;
  result.gain = residuals.squaredNorm() - (residuals + result.change).squaredNorm();
  if (!(result.gain > least_gain)) return std::nullopt;
  result.others = others_after(whole * way);
  return result;
}

std::vector<double> Scorer::others_after(const Eigen::VectorXd& change) const {
  Eigen::VectorXd way = solver_.solve(-(point_.base.residuals + change));
  const double most = options_.largest_log_step;
  for (std::size_t i = 0; i < space_.size(); ++i) {
    double& by = way[static_cast<Index>(i)];
    if (space_[i].scale != Scale::linear) by = std::clamp(by, -most, most);
  }
  return space_.values(point_.u + way);
}

std::optional<Eigen::VectorXd> Scorer::step_of_shapes(const EffectSetting& setting,
                                                      const Eigen::MatrixXd& derivatives) const {
  if (derivatives.size() == 0) return std::nullopt;
  const Eigen::MatrixXd columns = projected(derivatives);
  if (columns.size() == 0) return std::nullopt;
  const auto strengths = static_cast<Index>(setting.own.strengths.size());
  Eigen::VectorXd way(strengths);
  for (Index k = 0; k < strengths; ++k)
    way[k] = setting.own.strengths[static_cast<std::size_t>(k)] -
             setting.hypothesis->neutral[static_cast<std::size_t>(k)];
  const Eigen::VectorXd there = point_.residuals + columns.leftCols(strengths) * way;
  const Eigen::VectorXd step = LeastSquaresSolver(columns).solve(-there);
  if (!step.allFinite()) return std::nullopt;
  return step.tail(step.size() - strengths);
}

Eigen::MatrixXd Scorer::own_basis(const Eigen::MatrixXd& derivatives) const {
  if (derivatives.size() == 0) return {};
  const Eigen::MatrixXd columns = projected(derivatives);
  return columns.size() == 0 ? columns : basis_of(columns);
}

/// The derivatives without what the free parameters do; empty where nothing but rounding is left of
/// one.
Eigen::MatrixXd Scorer::projected(const Eigen::MatrixXd& derivatives) const {
  const Eigen::MatrixXd whole = with_priors(derivatives, point_.residuals.size());
  Eigen::MatrixXd columns = whole - point_.basis * (point_.basis.transpose() * whole);
  for (Index k = 0; k < columns.cols(); ++k)
    if (!(columns.col(k).norm() >= options_.least_own_part * whole.col(k).norm())) return {};
  return columns;
}

}  // namespace axisfit
