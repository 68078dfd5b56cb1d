#include "fit/search/extended_model.h"

#include <algorithm>

#include "fit/estimate/recipes.h"
#include "fit/solve/parameters.h"

namespace axisfit {

FitResult refit(const Job& job, const RunContext& context, int max_iterations) {
  Job quick = job;
  quick.options = recipe::refit(job, max_iterations);
  return estimate(quick, context.quiet());
}

FitResult refit_from(Job job, const std::vector<double>& values, const RunContext& context) {
  set_initial_values(job, values);
  return refit(job, context);
}

void resume(ExtendedModel& e, const RunContext& context) {
  constexpr int kMany = 100;
  Job near = e.job;
  set_initial_values(near, values_of(e.fit));
  near.options = recipe::polish(near.options);
  e.fit = refit(near, context, kMany);
  e.residuals = residual_series(e.job, e.fit);
}

ExtendedModel fit_extended_model(const Job& job, const Candidate& candidate,
                                 const std::vector<double>& values,
                                 const std::vector<double>& strengths,
                                 const std::vector<double>& shapes, const RunContext& context) {
  ExtendedModel e;
  e.candidate = candidate;
  e.job = with_candidate(job, candidate, values, strengths, shapes);
  // Of another transmission the settings tried are few, and far apart.
  constexpr int kMany = 100;
  e.fit = candidate.gives_backlash ? refit(e.job, context, kMany) : refit(e.job, context);
  e.residuals = residual_series(e.job, e.fit);
  return e;
}

CandidateValues candidate_values(const Job& job, const FitResult& fit, const Candidate& candidate) {
  Model<double> fitted = fitted_model(job, fit);
  const auto member = members(fitted);
  CandidateValues own;
  for (const std::size_t q : candidate.strengths) own.strengths.push_back(*member[q]);
  for (const std::size_t q : candidate.shapes) own.shapes.push_back(*member[q]);
  return own;
}

std::optional<ParameterId> shape_at_bound(const Job& job, const FitResult& fit,
                                          const Candidate& candidate) {
  if (!candidate.shapes_are_free) return std::nullopt;
  for (std::size_t i = 0; i < job.free.size(); ++i)
    if (std::ranges::find(candidate.shapes, job.free[i].quantity) != candidate.shapes.end() &&
        fit.parameters[i].uncertainty.at_bound)
      return fit.parameters[i].id;
  return std::nullopt;
}

double bic_advantage(const ExtendedModel& a, const ExtendedModel& b) {
  const double of_a =
      bic_difference(a.residuals, a.job.free.size(), b.residuals, b.job.free.size());
  const double of_b =
      bic_difference(b.residuals, b.job.free.size(), a.residuals, a.job.free.size());
  return of_a > 0.0 ? of_a : -of_b;
}

}  // namespace axisfit
