#include "fit/search/tried.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fit/estimate/recipes.h"
#include "fit/judge/missing_force.h"
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

FitResult polished_fit(Job job, const std::vector<double>& values, const SearchContext& context) {
  set_initial_values(job, values);
  job.options = recipe::polish(job.options);
  return estimate(job, context.run.quiet());
}

FitResult final_fit(Job job, const std::vector<double>& values, const SearchContext& context) {
  FitResult fit = polished_fit(job, values, context);
  // A minimum that leaves nothing but noise is no wrong one.
  if (fit.is_usable() && is_fitted_to_noise(residual_series(job, fit))) return fit;
  set_initial_values(job, values);
  job.options = recipe::final_fit(job);
  return estimate(job, context.run.quiet());
}

namespace {

/// A part of the way from these values, of a model without the hypothesis, to where a score puts
/// it: a whole step may go too far and end in another valley.
Scored part_of_the_way(Scored start, const std::vector<double>& values) {
  constexpr double part = 0.1;
  for (std::size_t i = 0; i < values.size(); ++i)
    start.others[i] = std::lerp(values[i], start.others[i], part);
  const std::vector<double>& neutral = start.hypothesis->neutral;
  for (std::size_t k = 0; k < neutral.size(); ++k)
    if (std::isfinite(neutral[k]))
      start.own.strengths[k] = std::lerp(neutral[k], start.own.strengths[k], part);
  return start;
}

}  // namespace

Tried try_hypothesis(const Job& job, const Scored& start, const SearchContext& context,
                     const Try& how) {
  Tried tried;
  tried.hypothesis = *start.hypothesis;
  tried.score = start.gain;
  const auto job_from = [&](const Scored& from) {
    Job with = with_hypothesis(job, tried.hypothesis, from.others, from.own);
    with.options.give_up_above = how.give_up_above;
    return with;
  };
  tried.job = job_from(start);
  const SearchOptions::Refit& limits = context.options.refit;
  const bool is_other_transmission = tried.hypothesis.kind == HypothesisKind::transmission;
  const bool is_nearby = how.is_nearby && !is_other_transmission;
  const auto polish = [&](Job near) {
    near.options = recipe::polish(near.options);
    tried.fit = refit(near, context);
  };
  const auto track = [&] {
    tried.fit = refit(tried.job, context,
                      is_other_transmission ? limits.many_iterations : limits.iterations);
  };
  const auto is_higher = [&] {
    return how.before != nullptr && !(reduced_cost(tried.fit) < reduced_cost(*how.before));
  };
  // The shapes of what does next to nothing wander.
  const bool has_strengths_alone =
      !is_other_transmission && tried.hypothesis.estimated_shapes().empty();
  if (is_nearby)
    polish(tried.job);
  else
    track();
  if (has_strengths_alone && is_higher())
    polish(job_from(part_of_the_way(start, values_of(*how.before))));
  if (is_nearby && is_higher()) track();
  tried.job.options.give_up_above = job.options.give_up_above;
  tried.residuals = residual_series(tried.job, tried.fit);
  return tried;
}

double worthless_cost(const FitResult& fit, const std::vector<ResidualSeries>& residuals,
                      std::size_t parameters, const SearchOptions& options) {
  double unit = 0.0, count = 0.0;
  for (const ResidualSeries& series : residuals) {
    if (!series.fitted) continue;
    unit = std::max(unit, mean_square(series.values) * autocorrelation_time(series.values));
    count += static_cast<double>(series.values.size());
  }
  const double loss =
      clear_difference(options) + static_cast<double>(parameters) * std::log(samples_of(residuals));
  return reduced_cost(fit) + 2.0 * loss * unit / std::max(1.0, count);
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
    // It was given up, or would have gone on for nothing.
    if (tried.fit.verdict.kind == FitVerdict::Kind::no_minimum)
      if (auto rejection = rejection_as_chance(tried.hypothesis, tried.gain, strictness.tried))
        tried.rejection = rejection;
    return;
  }
  tried.rejection =
      rejection_of(tried.hypothesis, tried.gain,
                   determination(tried.job, tried.fit, tried.hypothesis, tried.residuals, options),
                   strictness, options);
}

std::vector<double> missing_percents(const Job& job, const FitResult& fit) {
  const bool validates = std::ranges::count(job.recordings, Role::validate, &Recording::role) > 0;
  std::vector<double> percents;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    if (validates && job.recordings[r].role != Role::validate) continue;
    const MissingForce force = missing_force(job, fit, r);
    percents.push_back(force.found ? percent_of_drive(force) : NAN);
  }
  return percents;
}

std::optional<Rejection> rejection_by_force(const std::vector<double>& before,
                                            const std::vector<double>& after,
                                            const SearchOptions::Acceptance& limits) {
  for (std::size_t i = 0; i < before.size(); ++i)
    if (after[i] > limits.force_times * before[i] + limits.force_percent)
      return Rejection{.test = Rejection::Test::force, .found = after[i], .required = before[i]};
  return std::nullopt;
}

std::optional<Rejection> rejection_by_free_run(const FitResult& before, const FitResult& after) {
  for (std::size_t r = 0; r < before.recordings.size(); ++r)
    if (before.recordings[r].free_running.finished && !after.recordings[r].free_running.finished)
      return Rejection{.test = Rejection::Test::simulation};
  return std::nullopt;
}

std::optional<Rejection> rejection_as_indistinct(const FitResult& before, const FitResult& after) {
  constexpr double kTimes = 100.0;
  for (std::size_t i = 0; i < before.parameters.size(); ++i) {
    const ParameterUncertainty &known = before.parameters[i].uncertainty,
                               &now = after.parameters[i].uncertainty;
    if (known.determined && !now.at_bound &&
        !(now.determined && now.standard_error < kTimes * known.standard_error))
      return Rejection{.test = Rejection::Test::distinct};
  }
  return std::nullopt;
}

double periods_passed(const Job& job, const FitResult& fit, const Hypothesis& hypothesis) {
  double distance = 0.0;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    if (job.recordings[r].role != Role::fit) continue;
    const auto& samples = fit.recordings[r].as_fitted().samples;
    if (samples.empty()) continue;
    const auto [low, high] = std::ranges::minmax(samples, {}, &Sample::position);
    distance = std::max(distance, high.position - low.position);
  }
  Model<double> fitted = fitted_model(job, fit);
  const auto member = members(fitted);
  const auto effect = quantity_list()[hypothesis.strengths.front()].effect;
  for (const QuantityEntry& entry : quantity_list())
    if (entry.effect == effect && entry.quantity.shape) {
      const double value = *member[entry.index];
      return entry.quantity.unit == "m"
                 ? distance / value
                 : value * distance / (2.0 * std::numbers::pi * motor_radius(fitted));
    }
  return 0.0;
}

HypothesisValues values_in(const Tried& tried) {
  return values_in(tried.job, tried.fit, tried.hypothesis);
}

std::optional<Rejection> rejection_as_simpler(const Job& job, const FitResult& fit,
                                              const Hypothesis& hypothesis,
                                              const SearchOptions& options) {
  for (std::size_t k = 0; k < hypothesis.estimated_shapes().size(); ++k) {
    const auto found = std::ranges::find(job.free, hypothesis.shape(k), &FreeParameter::id);
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
