#include "fit/judge/second_opinion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "fit/estimate/recipes.h"
#include "fit/judge/grade.h"
#include "fit/solve/solve.h"

namespace axisfit {
namespace {

/// Sum of squared residuals of the job at these values, as at the end of a fit; infinite where a
/// simulation does not finish.
double cost_at(const Job& job, const std::vector<double>& values, double observer_gain) {
  const ParameterSpace space(job);
  const Eigen::VectorXd residuals = residuals_at(job, space, space.internal(values), observer_gain);
  return residuals.size() > 0 ? residuals.squaredNorm() : std::numeric_limits<double>::infinity();
}

/// Whether the missing force or the simulation tells that the model is wrong, or the fit is.
bool is_graded_wrong(const Job& job, const FitResult& fit) {
  return !grade_of(job, fit, Diagnosis{.forces = missing_forces(job, fit)}).is_usable();
}

}  // namespace

InverseStart try_inverse_start(Job& job, FitResult& fit, const RunContext& context) {
  const std::optional<InverseDynamics> estimate = inverse_dynamics(job);
  const GradeOptions options;
  if (!estimate || !(estimate->residual < options.useful_residual * estimate->drive_rms))
    return InverseStart::not_tried;
  const std::vector<double> from = start_from(job, *estimate);
  const double cost = cost_at(job, values_of(fit), fit.observer_gain);
  if (fit.is_usable() && !is_graded_wrong(job, fit) &&
      !(cost_at(job, from, fit.observer_gain) < cost))
    return InverseStart::not_tried;

  Job again = job;
  again.options = recipe::once(job.options);
  FitResult other = estimate_with_noise(again, context, from);
  again.options = job.options;
  const auto rank = [](const FitResult& f, double c) {
    return std::tuple(!f.is_usable(), f.verdict.kind == FitVerdict::Kind::not_simulated, c);
  };
  const double other_cost = cost_at(job, values_of(other), fit.observer_gain);
  if (!(rank(other, other_cost) < rank(fit, options.same_minimum * cost)))
    return InverseStart::no_better;
  other.starts.insert(other.starts.begin(), fit.starts.begin(), fit.starts.end());
  fit = std::move(other);
  job = std::move(again);
  return InverseStart::better;
}

std::optional<SecondOpinion> second_opinion(const Job& job, const FitResult& fit) {
  std::optional<InverseDynamics> estimate = inverse_dynamics(job);
  if (!estimate) return std::nullopt;
  SecondOpinion opinion{*std::move(estimate), {}};
  // Of the drive force: a balance that leaves more contradicts nothing.
  constexpr double kLeaves = 0.1;
  if (!(opinion.estimate.residual < kLeaves * opinion.estimate.drive_rms)) return opinion;
  const GradeOptions options;
  for (std::size_t i = 0; i < opinion.estimate.parameters.size() && opinion.estimate.exact; ++i) {
    const InverseEstimate& own = opinion.estimate.parameters[i];
    const ParameterResult& other = fit.parameters[own.parameter];
    const double error =
        std::hypot(own.uncertainty.standard_error, other.uncertainty.standard_error);
    const double difference = std::abs(own.value - other.value);
    const double size = std::max(std::abs(own.value), std::abs(other.value));
    if (fit.is_usable() && other.uncertainty.determined &&
        difference > options.contradiction_errors * error &&
        difference > options.contradiction_part * size)
      opinion.contradictions.push_back(i);
  }
  return opinion;
}

}  // namespace axisfit
