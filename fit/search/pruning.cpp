#include "fit/search/pruning.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "fit/errors/scatter.h"
#include "fit/estimate/other_gains.h"
#include "fit/search/catalogue.h"
#include "fit/search/rivals.h"
#include "fit/solve/parameters.h"

namespace axisfit {
namespace {

/// What the recordings to validate, fitted by themselves, say of an effect; nothing where they
/// cannot be.
std::optional<Replication> found_elsewhere(SearchState& state, const Hypothesis& hypothesis,
                                           const SearchContext& context) {
  if (!state.chain.has_elsewhere())
    state.report_progress(context.run, "do the recordings to validate tell the same?",
                          Work::trials);
  const std::optional<FitResult>& elsewhere = state.chain.elsewhere();
  if (!elsewhere) return std::nullopt;
  return replication(state.current().job, state.current().fit, *elsewhere, hypothesis,
                     context.options);
}

bool is_alike_elsewhere(SearchState& state, const Hypothesis& hypothesis,
                        const SearchContext& context) {
  const auto found = found_elsewhere(state, hypothesis, context);
  return found && found->is_alike;
}

/// Nothing else that may be missing repeats as often along the way.
bool repeats_often(const FittedModel& model, const Hypothesis& hypothesis,
                   const SearchOptions& options) {
  return hypothesis.has_phase &&
         periods_passed(model.job, model.fit, hypothesis) >= options.far_from_noise.periods;
}

/// How many standard errors a single strength is from neutral where its interval contains that;
/// none where it does not, there are several strengths, or what is neutral is infinite.
std::optional<double> errors_of_nothing(const Job& job,
                                        const std::vector<ParameterResult>& parameters,
                                        const Hypothesis& hypothesis) {
  const double neutral = hypothesis.neutral.front();
  if (hypothesis.strengths.size() != 1 || !std::isfinite(neutral)) return std::nullopt;
  const auto free = std::ranges::find(job.free, hypothesis.strength(0), &FreeParameter::id);
  const ParameterResult& p = parameters.at(static_cast<std::size_t>(free - job.free.begin()));
  const ParameterUncertainty known = combined(p.budget, p.value, *free);
  if (!known.determined) return 0.0;
  if (neutral < known.lower || neutral > known.upper) return std::nullopt;
  return std::abs(p.value - neutral) / known.standard_error;
}

/// The state with a plain rival in the place of an effect that has become no more than that; none
/// where there is no such.
std::optional<SearchState> with_plain_rival(SearchState& state, std::size_t place,
                                            const Rejection& rejection, int round,
                                            const SearchContext& context) {
  std::optional<Tried> plain = plain_rival(state, place, context);
  if (!plain) return std::nullopt;
  SearchState other = state;
  const Hypothesis hypothesis = state.accepted()[place].hypothesis;
  other.outcomes.fail(hypothesis, rejection);
  other.exchange(place, *std::move(plain), round);
  other.degenerate.push_back(hypothesis);
  // What is left at contacts differs by more than chance between models that are both complete.
  if (is_clearly_worse(loss_of(state.current(), other.current()), context.options) &&
      !(state.explained() && other.explained()))
    return std::nullopt;
  return other;
}

/// What a second element is, with these values, where the model lacks a first; none where it has
/// one.
std::optional<Hypothesis> first_of(const Job& job, const Hypothesis& second,
                                   const HypothesisValues& own) {
  SearchScales scales;
  scales.periods = own.shapes;  // if that is one: without any no period is offered
  for (Hypothesis& h : catalogue(job, scales)) {
    if (h.name != second.extends || h.parameters() != second.parameters() || h.held != second.held)
      continue;
    h.settings = second.settings;
    h.largest = second.largest;
    return std::move(h);
  }
  return std::nullopt;
}

}  // namespace

bool drop_degenerate(SearchState& state, int round, const SearchContext& context) {
  for (std::size_t a = 0; a < state.accepted().size(); ++a) {
    const Hypothesis hypothesis = state.accepted()[a].hypothesis;
    const auto rejection =
        rejection_as_simpler(state.current().job, state.current().fit, hypothesis, context.options);
    if (!rejection) continue;
    if (auto plain = with_plain_rival(state, a, *rejection, round, context)) {
      state = *std::move(plain);
      return true;
    }
    FittedModel before = state.chain.before(a);
    if (!before.fit.is_usable()) continue;
    while (state.accepted().size() > a + 1) {
      state.outcomes.reject(state.accepted().back().hypothesis, Reason::falls_with,
                            hypothesis.name);
      state.strike_off(state.accepted().size() - 1);
    }
    state.outcomes.fail(hypothesis, *rejection);
    state.take_out(a, std::move(before));
    state.degenerate.push_back(hypothesis);
    return true;
  }
  return false;
}

void eliminate_backward(SearchState& state, const SearchContext& context) {
  bool is_far = !state.explained();
  const auto is_plain = [&](std::size_t a) {
    return is_far ? is_alike_elsewhere(state, state.accepted()[a].hypothesis, context)
                  : state.chain.is_far_without(a);
  };
  for (std::size_t a = 0; a < state.accepted().size();) {
    const Accepted& effect = state.accepted()[a];
    state.report_progress(context.run, "is " + effect.hypothesis.name + " necessary?");
    if (is_plain(a)) {
      ++a;
      continue;
    }
    std::vector<std::size_t> doubted;
    for (std::size_t b = a; b < state.accepted().size(); ++b)
      if (!is_plain(b)) doubted.push_back(b);
    state.chain.fit_without(doubted);
    const FittedModel& reduced = state.chain.without(a);
    const Improvement gain = improvement(reduced, state.current());
    if (!reduced.fit.is_usable() || is_needed(gain, effect.hypothesis.parameters(),
                                              effect.is_seen_elsewhere, context.options)) {
      // What it was tried beside may have been taken out since.
      if (Outcome* outcome = state.outcomes.find(effect.hypothesis);
          outcome != nullptr && reduced.fit.is_usable())
        outcome->improvement = gain;
      ++a;
      continue;
    }
    state.outcomes.reject(effect.hypothesis, Reason::not_needed);
    state.take_out(a, reduced);
    is_far = !state.explained();
    a = 0;
  }
}

void drop_imitators(SearchState& state, const SearchContext& context) {
  while (!state.accepted().empty() && !state.explained()) {
    std::optional<std::size_t> least;
    double percent = context.options.far_from_noise.of_effect;
    for (std::size_t a = 0; a < state.accepted().size(); ++a) {
      const Hypothesis& hypothesis = state.accepted()[a].hypothesis;
      if (hypothesis.kind == HypothesisKind::curve ||
          repeats_often(state.current(), hypothesis, context.options) ||
          is_alike_elsewhere(state, hypothesis, context))
        continue;
      state.report_progress(context.run, "what does " + hypothesis.name + " explain?");
      const FittedModel& reduced = state.chain.without(a);
      if (!reduced.fit.is_usable()) continue;
      const double explained = improvement(reduced, state.current()).missing_percent;
      if (explained >= percent) continue;
      percent = explained;
      least = a;
    }
    if (!least) return;
    state.outcomes.fail(state.accepted()[*least].hypothesis,
                        {.test = Rejection::Test::share, .found = percent});
    state.take_out(*least, state.chain.without(*least));
  }
}

void drop_unreplicated_of_a_poor_model(SearchState& state, const SearchContext& context) {
  const std::optional<Rejection> rejection = rejection_of_all(state, context.options);
  for (std::size_t a = 0; rejection && a < state.accepted().size();) {
    const Hypothesis hypothesis = state.accepted()[a].hypothesis;
    if (repeats_often(state.current(), hypothesis, context.options) ||
        (!hypothesis.is_of_instrument() && is_alike_elsewhere(state, hypothesis, context))) {
      ++a;
      continue;
    }
    state.outcomes.fail(hypothesis, *rejection);
    state.take_out(a, state.chain.without(a));
  }
}

void drop_other_periods(SearchState& state, const SearchContext& context) {
  for (std::size_t a = 0; a < state.accepted().size();) {
    const Hypothesis hypothesis = state.accepted()[a].hypothesis;
    const auto found =
        hypothesis.has_phase ? found_elsewhere(state, hypothesis, context) : std::nullopt;
    if (!found || !found->has_other_period) {
      ++a;
      continue;
    }
    state.outcomes.fail(hypothesis,
                        {.test = Rejection::Test::period, .found = found->parameters.back().value});
    state.take_out(a, state.chain.without(a));
  }
}

void name_as_first(SearchState& state, const SearchContext& context) {
  // From the last: what is renamed goes last.
  for (std::size_t a = state.accepted().size(); a-- > 0;) {
    const Hypothesis second = state.accepted()[a].hypothesis;
    const bool has_parts = std::ranges::any_of(state.accepted(), [&](const Accepted& other) {
      return is_part_of(other.hypothesis, second);
    });
    if (second.extends.empty() || has_parts) continue;
    const HypothesisValues own = values_in(state.current().job, state.current().fit, second);
    const Job rest = state.chain.job_with_accepted(state.chain.declared().job, a);
    const std::optional<Hypothesis> first = first_of(rest, second, own);
    if (!first) continue;
    Job job = with_hypothesis(rest, *first, initial_values(rest), own);
    FitResult fit = refit(job, context);
    if (!fit.is_usable()) continue;
    state.rename(a, *first, {first->name, std::move(job), std::move(fit)});
  }
}

bool drop_undetermined(SearchState& state, const FittedModel& last, const SearchContext& context) {
  if (!last.fit.is_usable() || state.accepted().empty()) return false;
  const auto residuals = residual_series(last.job, last.fit);
  FitResult whole = last.fit;  // with its whole error
  // A complete model has the same estimates at every gain.
  if (!state.explained()) add_gain_errors(last.job, whole, context.run.quiet());
  add_scatter(last.job, whole.parameters, whole.observer_gain);
  std::optional<std::size_t> worst;
  Rejection rejection;
  double least = INFINITY;  // standard errors from zero
  for (std::size_t a = 0; a < state.accepted().size(); ++a) {
    const Hypothesis& hypothesis = state.accepted()[a].hypothesis;
    const Determination d =
        determination(last.job, last.fit, hypothesis, residuals, context.options);
    double errors = d.wald < d.required ? std::sqrt(d.wald) : INFINITY;
    if (const auto known = errors_of_nothing(last.job, whole.parameters, hypothesis);
        known && !is_alike_elsewhere(state, hypothesis, context))
      errors = std::min(errors, *known);
    if (d.at_bound) errors = 0.0;
    if (errors >= least) continue;
    least = errors;
    worst = a;
    rejection = d.at_bound ? Rejection{.test = Rejection::Test::bound, .parameter = d.at_bound}
                           : Rejection{.test = Rejection::Test::strength, .found = errors};
  }
  if (!worst || !state.chain.without(*worst).fit.is_usable()) return false;
  state.outcomes.fail(state.accepted()[*worst].hypothesis, rejection);
  state.take_out(*worst, state.chain.without(*worst));
  return true;
}

std::optional<Rejection> rejection_of_all(SearchState& state, const SearchOptions& options) {
  if (state.accepted().empty() || state.explained()) return std::nullopt;
  const double percent = improvement(state.chain.declared(), state.current()).missing_percent;
  if (percent >= options.far_from_noise.of_model) return std::nullopt;
  return Rejection{.test = Rejection::Test::share, .found = percent};
}

void record_replications(SearchState& state, const SearchContext& context) {
  for (const Accepted& a : state.accepted())
    if (Outcome* outcome = state.outcomes.find(a.hypothesis))
      if (auto found = found_elsewhere(state, a.hypothesis, context))
        outcome->replication = std::move(found);
}

}  // namespace axisfit
