#include "fit/errors/scatter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/distributions.h"
#include "fit/criterion/windows.h"
#include "fit/data/partition.h"
#include "fit/errors/residual_colour.h"
#include "fit/solve/parameters.h"
#include "fit/solve/solve.h"

namespace axisfit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The estimates by one group alone, on the scales of u.
struct Alone {
  VectorXd step;         ///< from the solution
  MatrixXd covariance;   ///< C_i
  MatrixXd information;  ///< J_i'J_i
};

/// Rows of a group in the linearisation: those of each of its series.
using Rows = std::vector<SeriesRows>;

/// The estimates by a group alone. The colour is that of the residual which it would leave alone:
/// its residual at the estimates of all groups has the scatter in it.
Alone alone(const VectorXd& residuals, const MatrixXd& jacobian, const Rows& rows,
            const ErrorOptions& options) {
  const Index n = jacobian.cols();
  Alone found{VectorXd::Zero(n), MatrixXd::Zero(n, n), MatrixXd::Zero(n, n)};
  VectorXd gradient = VectorXd::Zero(n);
  for (const SeriesRows& s : rows) {
    const auto j = jacobian.middleRows(s.first, s.count);
    found.information += j.transpose() * j;
    gradient += j.transpose() * residuals.segment(s.first, s.count);
  }
  const double open = options.open_deviation;
  const MatrixXd ridge = MatrixXd::Identity(n, n) / (open * open);
  const Eigen::LLT<MatrixXd> normal(found.information + ridge);
  found.step = -normal.solve(gradient);
  const MatrixXd middle = ridge + residual_colour(residuals + jacobian * found.step, jacobian, rows,
                                                  normal.solve(MatrixXd::Identity(n, n)), options)
                                      .middle;
  found.covariance = normal.solve(normal.solve(middle).transpose());
  return found;
}

/// The restricted likelihood of the variances in T, for groups of independent estimates.
class Likelihood {
 public:
  Likelihood(std::vector<Alone> groups, const ErrorOptions& options)
      : groups_(std::move(groups)), interval_fall_(options.interval_fall) {}

  double operator()(const VectorXd& variances) const {
    const Index n = variances.size();
    MatrixXd weights = MatrixXd::Zero(n, n);
    VectorXd weighted = VectorXd::Zero(n);
    double sum = 0.0;
    for (const Alone& group : groups_) {
      const MatrixXd spread = group.covariance + MatrixXd(variances.asDiagonal());
      const Eigen::LLT<MatrixXd> llt(spread);
      const VectorXd step = llt.solve(group.step);
      sum += log_determinant(llt) + group.step.dot(step);
      weighted += step;
      weights += llt.solve(MatrixXd::Identity(n, n));
    }
    const Eigen::LLT<MatrixXd> all(weights);
    return -0.5 * (sum + log_determinant(all) - weighted.dot(all.solve(weighted)));
  }

  /// The variances that maximise it: those of `held` stay, the others climb one by one.
  VectorXd maximise(VectorXd variances, const std::vector<bool>& held) const {
    constexpr int kSweeps = 8;
    constexpr double kSettled = 1e-3;
    double best = (*this)(variances);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      const double before = best;
      for (Index k = 0; k < variances.size(); ++k)
        if (!held[static_cast<std::size_t>(k)]) best = climb(variances, k, best);
      if (best - before < kSettled) break;
    }
    return variances;
  }

  /// The usual size of a variance of the k-th parameter.
  double usual(Index k) const {
    std::vector<double> sizes;
    for (const Alone& group : groups_) sizes.push_back(group.covariance(k, k));
    std::ranges::nth_element(sizes, sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2));
    return sizes[sizes.size() / 2];
  }

  /// The standard deviations of the k-th parameter at which the likelihood is significantly lower
  /// than at the best variances, downwards and upwards. The other variances stay.
  std::pair<double, double> interval(const VectorXd& variances, Index k) const {
    constexpr int kHalvings = 40;  // to rounding
    const double best = (*this)(variances);
    const auto at = [&](double deviation) {
      VectorXd other = variances;
      other[k] = deviation * deviation;
      return (*this)(other);
    };
    const auto crossing = [&](double inside, double outside) {
      for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (inside + outside);
        (best - at(middle) < interval_fall_ ? inside : outside) = middle;
      }
      return inside;
    };
    const double here = std::sqrt(variances[k]);
    double beyond = std::max(here, 0.1 * std::sqrt(usual(k)));
    for (int i = 0; i < kHalvings && best - at(beyond) < interval_fall_; ++i) beyond *= 2.0;
    return {best - at(0.0) < interval_fall_ ? 0.0 : crossing(here, 0.0), crossing(here, beyond)};
  }

 private:
  static double log_determinant(const Eigen::LLT<MatrixXd>& llt) {
    return 2.0 * llt.matrixL().toDenseMatrix().diagonal().array().log().sum();
  }

  /// Puts the best value of one variance in its place, zero or on a grid of its logarithm and then
  /// between; returns the likelihood there.
  double climb(VectorXd& variances, Index k, double best) const {
    const double usual_size = usual(k);
    double found = variances[k];
    const auto try_value = [&](double value) {
      VectorXd other = variances;
      other[k] = value;
      if (const double here = (*this)(other); here > best) {
        best = here;
        found = value;
      }
    };
    try_value(0.0);
    for (int i = -8; i <= 24; ++i) try_value(usual_size * std::pow(2.0, i));
    for (double factor = std::sqrt(2.0); factor > 1.01; factor = std::sqrt(factor)) {
      const double middle = found;
      for (const double value : {middle / factor, middle * factor}) try_value(value);
    }
    variances[k] = found;
    return best;
  }

  std::vector<Alone> groups_;
  double interval_fall_;
};

/// One part of so many of a series.
SeriesRows part_of(const SeriesRows& rows, std::size_t part, std::size_t parts) {
  const Partition partition(static_cast<std::size_t>(rows.count), parts);
  return {rows.recording, rows.measurement, rows.first + static_cast<Index>(partition.first(part)),
          static_cast<Index>(partition.size(part))};
}

/// Into how many stretches the only recording is divided; one: it is too short.
std::size_t stretches_of(const Linearization& at, std::size_t recording,
                         const ErrorOptions& options) {
  Index rows = 0;
  for (const SeriesRows& s : at.series)
    if (s.recording == recording) rows = std::max(rows, s.count);
  return static_cast<std::size_t>(
      std::clamp<Index>(rows / options.stretch_rows, 1, options.most_stretches));
}

/// Whether a stretch of the only fitted recording hardly depends on those before it.
bool forgets_within_stretches(const Job& job, const ErrorOptions& options) {
  if (tracks(job.options.criterion)) return true;
  const auto fitted = std::ranges::find(job.recordings, Role::fit, &Recording::role);
  const std::size_t windows =
      window_starts(job, static_cast<std::size_t>(fitted - job.recordings.begin())).size();
  return windows >= static_cast<std::size_t>(options.most_stretches);
}

/// The groups with their rows.
std::vector<Rows> group(const Job& job, const Linearization& at, const ErrorOptions& options,
                        Scatter& scatter) {
  std::vector<Rows> groups;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const bool is_fitted = job.recordings[r].role == Role::fit;
    const std::size_t parts = scatter.of_stretches && is_fitted ? stretches_of(at, r, options) : 1;
    const double start = job.recordings[r].times.front(),
                 length = job.recordings[r].times.back() - start;
    for (std::size_t p = 0; p < parts; ++p) {
      Rows rows;
      for (const SeriesRows& s : at.series)
        if (s.recording == r) rows.push_back(part_of(s, p, parts));
      if (rows.empty()) continue;
      const auto end_of = [&](std::size_t n) {
        return start + length * static_cast<double>(n) / static_cast<double>(parts);
      };
      scatter.groups.push_back({r, is_fitted, end_of(p), end_of(p + 1)});
      groups.push_back(std::move(rows));
    }
  }
  return groups;
}

}  // namespace

bool is_of_machine(const Job& job, std::size_t i) {
  return !job.free[i].recording && quantity_list()[job.free[i].quantity].group != "initial";
}

std::size_t Scatter::fitted_groups() const {
  return static_cast<std::size_t>(std::ranges::count(groups, true, &Group::fitted));
}

std::optional<Scatter> scatter_of(const Job& job, std::span<const ParameterResult> parameters,
                                  double observer_gain, const ErrorOptions& options) {
  Scatter scatter;
  scatter.of_stretches = std::ranges::count(job.recordings, Role::fit, &Recording::role) == 1;
  if (scatter.of_stretches && !forgets_within_stretches(job, options)) return std::nullopt;
  Job all = job;
  for (Recording& r : all.recordings) r.role = Role::fit;
  const ParameterSpace space(all);
  const VectorXd u = space.internal(values_of(parameters));
  const Linearization at = linearize(all, space, u, observer_gain);
  if (!at.finite) return std::nullopt;

  std::vector<Index> columns;     // inside their bounds
  std::vector<Index> of_machine;  // their places among those
  for (std::size_t i = 0; i < space.size(); ++i) {
    if (parameters[i].uncertainty.at_bound) continue;
    if (is_of_machine(job, i) && parameters[i].uncertainty.determined)
      of_machine.push_back(static_cast<Index>(columns.size()));
    columns.push_back(static_cast<Index>(i));
  }
  const std::vector<Rows> groups = group(job, at, options, scatter);
  if (of_machine.empty() || scatter.fitted_groups() < 2) return std::nullopt;

  const MatrixXd jacobian = at.jacobian(Eigen::all, columns);
  std::vector<Alone> each, fitted;
  MatrixXd information =
      MatrixXd::Zero(static_cast<Index>(columns.size()), static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < groups.size(); ++k) {
    each.push_back(alone(at.residuals, jacobian, groups[k], options));
    if (!scatter.groups[k].fitted) continue;
    information += each.back().information;
    fitted.push_back(
        {each.back().step(of_machine), each.back().covariance(of_machine, of_machine), {}});
  }

  const Likelihood likelihood(fitted, options);
  const auto n = static_cast<Index>(of_machine.size());
  std::vector<bool> held(of_machine.size(), false);
  VectorXd variances = likelihood.maximise(VectorXd::Zero(n), held);
  // The least significant goes, until all that remain are significant.
  for (;;) {
    Index least = -1;
    double lowest = chi_square_upper_quantile(2.0 * options.scatter_significance, 1.0);
    for (Index k = 0; k < n; ++k) {
      if (!(variances[k] > 0.0)) continue;
      VectorXd without = variances;
      without[k] = 0.0;
      std::vector<bool> fixed = held;
      fixed[static_cast<std::size_t>(k)] = true;
      without = likelihood.maximise(without, fixed);
      const double ratio = 2.0 * (likelihood(variances) - likelihood(without));
      if (ratio < lowest) {
        lowest = ratio;
        least = k;
      }
    }
    if (least < 0) break;
    held[static_cast<std::size_t>(least)] = true;
    variances[least] = 0.0;
    variances = likelihood.maximise(variances, held);
  }

  // The variance of the estimates within groups, and what the scatter adds.
  // (That of the whole fit has the scatter in its residual.)
  const Eigen::LDLT<MatrixXd> normal(information);
  VectorXd inside = VectorXd::Zero(n), added = VectorXd::Zero(n);
  for (std::size_t k = 0; k < each.size(); ++k) {
    if (!scatter.groups[k].fitted) continue;
    const MatrixXd part = normal.solve(each[k].information);
    const MatrixXd weights = part(of_machine, of_machine);
    inside += (part * each[k].covariance * part.transpose()).diagonal()(of_machine);
    added += weights.cwiseAbs2() * variances;
  }
  for (Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(
        columns[static_cast<std::size_t>(of_machine[static_cast<std::size_t>(k)])]);
    const ParameterResult& estimate = parameters[i];
    const double here = u[static_cast<Index>(i)], slope = std::abs(space.slope(i, here));
    ParameterScatter found{.parameter = i, .deviation = std::sqrt(variances[k]) * slope};
    const auto [lower, upper] = likelihood.interval(variances, k);
    found.lower = lower * slope;
    found.upper = upper * slope;
    for (std::size_t g = 0; g < each.size(); ++g) {
      const Index place = of_machine[static_cast<std::size_t>(k)];
      const double error = std::sqrt(each[g].covariance(place, place));
      found.groups.push_back({space.value(i, here + each[g].step[place]), error * slope,
                              error < options.largest_error});
    }
    ErrorBudget budget = estimate.budget;
    if (variances[k] > 0.0 && slope > 0.0) {
      // The scatter is as well known as the groups that tell the parameter are many.
      double weight = 0.0, square = 0.0;
      for (const Alone& group : fitted) {
        const double w = 1.0 / (group.covariance(k, k) + variances[k]);
        weight += w;
        square += w * w;
      }
      found.error = budget.scatter =
          ScatterError{.inside = std::sqrt(inside[k]) * slope,
                       .between = std::sqrt(added[k]) * slope,
                       .degrees_of_freedom = std::max(1.0, weight * weight / square - 1.0)};
    }
    found.within = error_within_groups(budget, estimate.value);
    scatter.parameters.push_back(std::move(found));
  }
  return scatter;
}

std::optional<Scatter> add_scatter(const Job& job, std::span<ParameterResult> parameters,
                                   double observer_gain, const ErrorOptions& options) {
  std::optional<Scatter> scatter = scatter_of(job, parameters, observer_gain, options);
  if (scatter)
    for (const ParameterScatter& p : scatter->parameters)
      parameters[p.parameter].budget.scatter = p.error;
  return scatter;
}

}  // namespace axisfit
