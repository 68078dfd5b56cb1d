#include "fit/errors/guesses.h"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"
#include "fit/solve/solve.h"

namespace axisfit {

std::vector<std::vector<GuessInfluence>> guess_influences(
    const Job& job, std::span<const ParameterResult> parameters, double observer_gain,
    const ErrorOptions& options) {
  std::vector<std::vector<GuessInfluence>> influences(parameters.size());
  Job extended = job;
  std::vector<double> values = values_of(parameters);
  for (const std::size_t g : job.guessed) {
    const double value = *members(extended.model)[g];
    if (value == 0.0 || std::ranges::count(job.free, g, &FreeParameter::quantity) > 0) continue;
    FreeParameter& guess = extended.free.emplace_back();
    guess.quantity = g;
    guess.initial = guess.lower = guess.upper = value;
    guess.scale = value > 0.0 ? Scale::logarithmic : Scale::linear;
    values.push_back(value);
  }
  std::vector<Eigen::Index> moving;
  for (std::size_t i = 0; i < influences.size(); ++i)
    if (!parameters[i].uncertainty.at_bound) moving.push_back(static_cast<Eigen::Index>(i));
  if (extended.free.size() == influences.size() || moving.empty()) return influences;

  const ParameterSpace space(extended);
  const Eigen::VectorXd u = space.internal(values);
  const Linearization at = linearize(extended, space, u, observer_gain);
  if (!at.finite) return influences;
  const Eigen::MatrixXd j = at.jacobian(Eigen::all, moving);
  const auto first = static_cast<Eigen::Index>(influences.size());
  const Eigen::MatrixXd moves =
      -LeastSquaresSolver(j).solve(at.jacobian.rightCols(at.jacobian.cols() - first));
  /// d ln value / d u
  const auto relative_slope = [&](std::size_t i) {
    return space.slope(i, u[static_cast<Eigen::Index>(i)]) / values[i];
  };
  for (std::size_t g = influences.size(); g < space.size(); ++g)
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const auto i = static_cast<std::size_t>(moving[k]);
      const ParameterUncertainty& known = parameters[i].uncertainty;
      const double elasticity =
          moves(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(g) - first) *
          relative_slope(i) / relative_slope(g);
      if (!known.determined || !std::isfinite(elasticity)) continue;
      const double shift = options.guess_change * std::abs(elasticity);
      if (shift > options.guess_move || shift * std::abs(values[i]) > known.standard_error)
        influences[i].push_back({space[g].id(), elasticity});
    }
  return influences;
}

}  // namespace axisfit
