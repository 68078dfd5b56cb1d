#include "fit/search/tried.h"

#include <algorithm>

#include "fit/estimate/recipes.h"
#include "fit/solve/parameters.h"

namespace axisfit {

FitResult refit(const Job& job, const SearchContext& context, int max_iterations) {
  Job quick = job;
  quick.options = recipe::refit(job, max_iterations);
  return estimate(quick, context.run.quiet());
}

FitResult refit(const Job& job, const SearchContext& context) {
  return refit(job, context, context.options.refit.iterations);
}

FitResult refit_from(Job job, const std::vector<double>& values, const SearchContext& context) {
  set_initial_values(job, values);
  return refit(job, context);
}

Tried try_hypothesis(const Job& job, const Scored& start, const SearchContext& context) {
  Tried tried;
  tried.hypothesis = *start.hypothesis;
  tried.score = start.gain;
  tried.job = with_hypothesis(job, tried.hypothesis, start.others, start.own);
  const SearchOptions::Refit& limits = context.options.refit;
  tried.fit = refit(tried.job, context,
                    tried.hypothesis.kind == HypothesisKind::transmission ? limits.many_iterations
                                                                          : limits.iterations);
  tried.residuals = residual_series(tried.job, tried.fit);
  return tried;
}

void resume(Tried& tried, const SearchContext& context) {
  Job near = tried.job;
  set_initial_values(near, values_of(tried.fit));
  near.options = recipe::polish(near.options);
  tried.fit = refit(near, context, context.options.refit.many_iterations);
  tried.residuals = residual_series(tried.job, tried.fit);
}

void judge(Tried& tried, const std::vector<ResidualSeries>& before, const Strictness& strictness,
           const SearchOptions& options) {
  tried.gain = improvement(before, tried.residuals);
  if (!tried.fit.is_usable()) {
    tried.rejection = Rejection{.test = Rejection::Test::fit};
    return;
  }
  tried.rejection =
      rejection_of(tried.hypothesis, tried.gain,
                   determination(tried.job, tried.fit, tried.hypothesis, tried.residuals, options),
                   strictness, options);
}

HypothesisValues values_in(const Tried& tried) {
  return values_in(fitted_model(tried.job, tried.fit), tried.hypothesis);
}

std::optional<Rejection> rejection_as_simpler(const Job& job, const FitResult& fit,
                                              const Hypothesis& hypothesis,
                                              const SearchOptions& options) {
  if (!hypothesis.estimates_shapes()) return std::nullopt;
  for (std::size_t k = 0; k < hypothesis.shapes.size(); ++k) {
    const auto found = std::ranges::find(job.free, hypothesis.shapes[k], &FreeParameter::quantity);
    if (found == job.free.end()) continue;
    const ParameterResult& p = fit.parameters[static_cast<std::size_t>(found - job.free.begin())];
    if (p.uncertainty.at_bound) return Rejection{.test = Rejection::Test::bound, .parameter = p.id};
    const auto [least, most] = hypothesis.range_tried(k);
    const double beyond = options.acceptance.times_tried;
    if (hypothesis.settings.size() > 1 && least > 0.0 &&
        (p.value > beyond * most || p.value < least / beyond))
      return Rejection{.test = Rejection::Test::span, .found = p.value, .parameter = p.id};
  }
  return std::nullopt;
}

double bic_advantage(const Tried& a, const Tried& b) {
  const double of_a =
      bic_difference(a.residuals, a.job.free.size(), b.residuals, b.job.free.size());
  const double of_b =
      bic_difference(b.residuals, b.job.free.size(), a.residuals, a.job.free.size());
  return of_a > 0.0 ? of_a : -of_b;
}

}  // namespace axisfit
