#include "fit/search/strategies.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include "fit/criterion/gains.h"
#include "fit/search/exchange_score.h"
#include "fit/search/held_shapes.h"
#include "fit/search/pairs.h"
#include "fit/search/pruning.h"
#include "fit/search/rivals.h"
#include "fit/search/shortlist.h"
#include "sim/effects/effects.h"

namespace axisfit {
namespace {

bool has_room(const SearchState& state, const Rounds& rounds) {
  return state.accepted().size() < static_cast<std::size_t>(rounds.context.options.max_effects);
}

/// Whether the fitted recordings have nothing left for an effect to explain.
bool is_fitted_to_noise(const SearchState& state) {
  return is_fitted_to_noise(residual_series(state.current().job, state.current().fit));
}

/// A hypothesis that gains beside an accepted effect of its kind, and only there, may be what that
/// imitates: it becomes its rival. A curve can imitate anything, and explains nothing.
void note_relative(const Tried& tried, ModelChain& chain) {
  using enum Rejection::Test;
  constexpr std::array kOfValidation{validation, power, validation_size};
  if (tried.hypothesis.kind == HypothesisKind::constant ||
      tried.hypothesis.kind == HypothesisKind::curve || !tried.rejection ||
      std::ranges::find(kOfValidation, tried.rejection->test) == kOfValidation.end())
    return;
  for (Accepted& accepted : chain.accepted()) {
    const auto is_known = [&](const Scored& rival) {
      return is_same(*rival.hypothesis, tried.hypothesis);
    };
    if (accepted.hypothesis.acts_on == tried.hypothesis.acts_on &&
        std::ranges::none_of(accepted.rivals, is_known))
      accepted.rivals.push_back(
          {std::make_shared<const Hypothesis>(tried.hypothesis), values_in(tried)});
  }
}

/// The best of a round as part of the model, with those that it did not clearly beat: they are seen
/// again when all else is explained. So are those of more parameters, which the rounds to come may
/// tell from it.
Accepted accepted_from(const RoundResult& round, const Tried& best, const SearchOptions& options) {
  Accepted accepted{best.hypothesis, {}, best.replication || best.on_blocks};
  for (const Tried& other : round.models) {
    if (&other == &best || !other.fit.is_usable() || !other.gain.comparable) continue;
    // Beside what is accepted later the best may turn out to be no more than the plain one.
    if (is_clearly_worse(bic_advantage(best, other), options) &&
        !is_plain_beside(other.hypothesis, best.hypothesis))
      continue;
    accepted.rivals.push_back(
        {std::make_shared<const Hypothesis>(other.hypothesis), values_in(other)});
  }
  for (const Scored& other : round.unrefitted)
    if (!is_same_form(*other.hypothesis, best.hypothesis) &&
        other.hypothesis->kind != HypothesisKind::transmission)
      accepted.rivals.push_back({other.hypothesis, {{}, other.own.shapes}});
  return accepted;
}

/// Whether what was found leaves so little that the rest is worth no more than plain rounds: beside
/// it the recordings to validate have the last word, and it masks nothing.
bool has_left_little(const SearchState& state, const SearchOptions& options) {
  return !state.accepted().empty() && leaves_little(state.current(), options);
}

bool has_room_for_two(const SearchState& state, const SearchOptions& options) {
  return state.accepted().size() + 2 <= static_cast<std::size_t>(options.max_effects);
}

/// Both, with what else promises much of what they do and acts on the same as their rivals.
void append_pair(SearchState& state, TriedPair pair, const Shortlist& list, const Rounds& rounds) {
  state.outcomes.record_pair(pair.first, pair.second, rounds.count);
  std::vector<Shortlist::Promise> others = list.promises;
  std::ranges::stable_sort(others, std::greater{}, &Shortlist::Promise::gain);
  for (Tried* one : {&pair.first, &pair.second}) {
    Accepted accepted{one->hypothesis, {}};
    const double least =
        rounds.context.options.shortlist.worth * list.promised_by(one->hypothesis).value_or(0.0);
    for (const Shortlist::Promise& other : others)
      if (other.hypothesis->kind == HypothesisKind::effect && other.gain > least &&
          other.hypothesis->acts_on == one->hypothesis.acts_on &&
          !is_same_form(*other.hypothesis, one->hypothesis))
        accepted.rivals.push_back({other.hypothesis, {{}, other.shapes}});
    state.chain.append(std::move(accepted), std::move(one->job), std::move(one->fit));
  }
}

/// Adds the hypothesis that explains the most, or two that do only together; whether any pass.
bool add_best(SearchState& state, bool curves, double chance, Rounds& rounds) {
  const auto begin = std::chrono::steady_clock::now();
  ++rounds.count;
  const std::size_t before = state.accepted().size();
  RoundResult round = try_round(
      state.current(),
      {.curves = curves,
       .pairs = !curves && !state.explained() && has_room_for_two(state, rounds.context.options),
       .chance = chance,
       .elsewhere = !rounds.held_out_blocks && !has_left_little(state, rounds.context.options),
       .explained = state.explained(),
       .excluded = state.degenerate},
      curves ? rounds.of_curves : rounds.of_names, rounds.context);
  Tried* best = round.best ? &round.models[*round.best] : nullptr;
  if (best != nullptr) best = best_beside_held(best, round.models, state, rounds.context);
  for (const Tried& tried : round.models) state.outcomes.record(tried, best, rounds.count);
  if (round.pair) {
    append_pair(state, *std::move(round.pair), *rounds.of_names.list, rounds);
  } else if (best != nullptr) {
    Accepted accepted = accepted_from(round, *best, rounds.context.options);
    state.chain.append(std::move(accepted), std::move(best->job), std::move(best->fit));
  } else {
    for (const Tried& tried : round.models) note_relative(tried, state.chain);
  }
  const bool is_any = state.accepted().size() > before;
  if (is_any) {
    if (has_contacts(state.current()) && !tracks(state.current().job.options.criterion) &&
        !state.explained())
      state.chain.set_fit(settled(state.current(), rounds.context).fit);
    reconsider_held(state, before, rounds.context);
  }
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  rounds.context.run.report(
      {.phase = "search",
       .best = state.current().fit.reduced_chi_square,
       .finished = fmt::format("round {}, {:.1f} s: {}", rounds.count, time.count(),
                               is_any ? state.current().added : "none"),
       .work = Work::substitutes});
  return is_any;
}

bool add_best(SearchState& state, bool curves, Rounds& rounds) {
  return add_best(state, curves, rounds.context.options.acceptance.chance, rounds);
}

/// Whether a push of the arm, at a time of its own, promises most of what is missing.
bool is_a_push(const FittedModel& model, const SearchContext& context) {
  const Shortlist curves =
      shortlist(model.job, values_of(model.fit), {score_gains(model.job).front()}, true, context);
  return curves.has_most && !curves.entries.empty() &&
         quantity_list()[curves.entries.front().hypothesis->strengths.front()].effect ==
             effect_named(ForceOverTime<double>::name);
}

/// Adds two hypotheses that hide each other; whether there were any. Two laws of the motion are no
/// push.
bool add_pair(SearchState& state, Rounds& rounds) {
  const SearchOptions& options = rounds.context.options;
  if (rounds.of_names.has_no_pair || state.explained() || is_fitted_to_noise(state) ||
      has_left_little(state, options) || !has_room_for_two(state, options))
    return false;
  if (state.accepted().empty() && is_a_push(state.current(), rounds.context)) {
    rounds.of_names.has_no_pair = true;
    return false;
  }
  state.report_progress(rounds.context.run, "do two effects hide each other?", Work::trials);
  const Shortlist& list = *rounds.of_names.list;
  std::vector<Shortlist::Promise> hypotheses = list.promises;
  std::erase_if(hypotheses, [&](const Shortlist::Promise& p) {
    return std::ranges::any_of(state.degenerate, [&](const Hypothesis& other) {
      return is_same_form(*p.hypothesis, other);
    });
  });
  // Where the free run is lost, at the gain at which single effects are compared, too.
  const FittedModel& model = state.current();
  const std::vector<double> gains =
      is_lost(model, options) ? std::vector{search_gain(model.job)} : list.observer_gains;
  for (const ScoredPair& pair : score_pairs(model, gains, hypotheses, rounds.context)) {
    std::optional<TriedPair> found = try_pair(model, pair, rounds.context);
    if (!found) continue;
    ++rounds.count;
    append_pair(state, *std::move(found), list, rounds);
    return true;
  }
  rounds.of_names.has_no_pair = true;
  return false;
}

/// Exchanges the first accepted effect that has a clearly better rival; whether there was one.
bool exchange(SearchState& state, const Rounds& rounds) {
  std::optional<TriedRival> found = better_rival(state, *rounds.of_names.list, rounds.context);
  if (!found) return false;
  Tried& better = found->tried;
  state.outcomes.reject(state.accepted()[found->place].hypothesis, Reason::replaced,
                        better.hypothesis.name);
  state.exchange(found->place, std::move(better), rounds.count);
  // One setting of a rival is tried.
  reconsider_held(state, state.accepted().size(), rounds.context);
  return true;
}

/// Whether the free run with what was found while tracking is near the data.
bool is_near_freely(SearchState& state, const SearchOptions& options) {
  return !state.accepted().empty() && is_near(state.current(), options) &&
         is_near(state.chain.free_run(), options);
}

/// Noise of the readings drives a simulation that tracks, and it takes a part of small effects upon
/// itself: as soon as the free run is near the data, the search goes on with that.
void leave_tracking(SearchState& state, const Rounds& rounds) {
  if (!rounds.free || !tracks(state.current().job.options.criterion) ||
      !is_near_freely(state, rounds.context.options))
    return;
  state.chain.replace(*rounds.free, FittedModel(state.chain.free_run()));
  state.chain.set_free(std::nullopt);
}

/// named(), but for a stop.
void add_named(SearchState& state, Rounds& rounds) {
  bool may_exchange = true;
  do {
    while (has_room(state, rounds)) {
      leave_tracking(state, rounds);
      if (add_best(state, false, rounds)) continue;
      if (drop_degenerate(state, rounds.count, rounds.context)) continue;
      if (may_exchange && !state.accepted().empty()) {
        may_exchange = false;
        if (exchange(state, rounds)) continue;
      }
      if (!add_pair(state, rounds)) break;
    }
  } while (drop_degenerate(state, rounds.count, rounds.context));
}

bool is_better(const FittedModel& a, const FittedModel& b, const SearchOptions& options) {
  return a.fit.is_usable() && is_clearly_worse(loss_of(a, b), options);
}

/// Whether a model with a curve in the place of the accepted effects could explain the recordings
/// about as well, if it left nothing but noise.
bool can_gain_by_a_curve(const SearchState& state, const SearchOptions& options) {
  double more = options.curve_coefficients;
  for (const Accepted& a : state.accepted()) more -= static_cast<double>(a.hypothesis.parameters());
  const FittedModel& model = state.current();
  return !is_clearly_worse(least_bic_difference(residual_series(model.job, model.fit), more),
                           options);
}

/// Whether any of the curves that were scored could do what the accepted effects do.
bool is_a_curve_in_reach(const SearchState& state, const std::optional<Shortlist>& curves,
                         const SearchOptions& options) {
  if (!curves) return true;
  return std::ranges::any_of(curves->promises, [&](const Shortlist::Promise& curve) {
    const auto score = exchange_score(state.current(), state.accepted(), state.chain.declared().job,
                                      {curve.hypothesis, {{}, curve.hypothesis->settings.front()}});
    return !score || !is_out_of_reach(*score, options);
  });
}

/// Whether a search that began with a curve explains more than one that did not. A curve has a
/// mean, too: what is not fitted must tell it from a named effect.
bool is_proven(const FittedModel& from_curve, const FittedModel& other, bool other_has_curve,
               const SearchOptions& options) {
  const Improvement gain = improvement(other, from_curve);
  if (!gain.comparable || !(gain.p_value < options.acceptance.chance)) return false;
  const double loss = loss_of(other, from_curve);
  return !(loss > 0.0 && (other_has_curve || is_clearly_worse(loss, options)));
}

/// Whether a search is at its end: it was stopped, if only while this was asked, or has explained
/// everything.
bool is_over(SearchState& state) {
  try {
    return state.interrupted || state.explained();
  } catch (const Interrupted&) {
    return state.interrupted = true;
  }
}

/// The state that a strategy ends in, or if that is stopped the state before it.
template <class Strategy>
SearchState finished(const SearchState& before, Strategy&& strategy) {
  try {
    return strategy(before);
  } catch (const Interrupted&) {
    SearchState kept = before;
    kept.interrupted = true;
    return kept;
  }
}

/// Whether what was found takes so much of the error beyond the noise away, %.
bool takes(double percent, const SearchState& state) {
  return improvement(state.chain.declared(), state.current()).missing_percent >= percent;
}

/// Whether a curve is part of a model that holds. What is left beside it is how it differs from the
/// truth: no effect that could be told from it.
bool is_left_by_a_curve(const SearchState& state, const SearchOptions& options) {
  return std::ranges::any_of(
             state.accepted(),
             [](const Accepted& a) { return a.hypothesis.kind == HypothesisKind::curve; }) &&
         takes(options.far_from_noise.of_model, state);
}

/// together(), of a state that holds what was found when this is stopped.
void find_together(SearchState& state, Rounds& rounds) {
  const std::vector<Accepted> known = state.accepted();
  const FittedModel declared = state.chain.declared();
  const bool is_continued = declared.job.options.is_continued();
  if (is_continued) {
    state.restart(tracking(declared, search_gain(declared.job), rounds.context));
    state.chain.set_free(declared.job);
  }
  const double chance = rounds.context.options.acceptance.provisional_chance;
  do {
    while (state.current().fit.is_usable() && has_room(state, rounds) && !state.explained() &&
           !(is_continued && is_near_freely(state, rounds.context.options)) &&
           add_best(state, false, chance, rounds)) {
    }
  } while (drop_degenerate(state, rounds.count, rounds.context));
  // No name for what is missing, but a pulse of force is seen as well by a simulation that tracks.
  if (state.accepted().empty() && state.current().fit.is_usable() && has_room(state, rounds) &&
      !state.explained())
    add_best(state, true, rounds);
  const bool is_new = std::ranges::any_of(state.accepted(), [&](const Accepted& found) {
    return std::ranges::none_of(
        known, [&](const Accepted& other) { return is_same(found.hypothesis, other.hypothesis); });
  });
  if (!is_new) return state.restart(declared);
  if (is_continued) {
    FittedModel all = state.chain.free_run();
    if (!all.fit.is_usable()) return state.restart(declared);
    state.chain.replace(declared, std::move(all));
  }
  if (is_left_by_a_curve(state, rounds.context.options)) return;
  add_named(state, rounds);
  eliminate_backward(state, rounds.context);
}

/// Whether all that was found acts on the machine. In what instruments and clocks do a simulation
/// that tracks takes part, and another transmission has other states.
bool is_all_of_the_machine(const SearchState& state) {
  return std::ranges::all_of(state.accepted(), [](const Accepted& a) {
    return a.hypothesis.kind == HypothesisKind::effect;
  });
}

/// Named effects, in the order in which that is quick: where refits by the free run are costly and
/// fail, they are found together first.
SearchState with_named_effects(const SearchState& declared, bool tracks, Rounds& rounds) {
  const SearchOptions& options = rounds.context.options;
  const auto better_of = [&](SearchState best, SearchState other) {
    best.interrupted = other.interrupted;
    return is_better(other.current(), best.current(), options) ? std::move(other) : std::move(best);
  };
  if (is_lost(declared.current(), options)) {
    SearchState best = declared;
    try {
      find_together(best, rounds);
    } catch (const Interrupted&) {
      best.interrupted = true;
    }
    const bool is_end = is_over(best);
    if (best.interrupted || takes(options.far_from_noise.of_complete_model, best) ||
        (is_end && is_all_of_the_machine(best)))
      return best;
    SearchState other = named(declared, rounds);
    if (is_over(other) && !other.interrupted) return other;
    return better_of(std::move(best), std::move(other));
  }
  SearchState best = named(declared, rounds);
  if (is_over(best) || tracks || has_left_little(best, options) || is_fitted_to_noise(best))
    return best;
  SearchState other = finished(best, [&](const SearchState& s) { return together(s, rounds); });
  return better_of(std::move(best), std::move(other));
}

}  // namespace

FittedModel tracking(FittedModel model, double gain, const SearchContext& context) {
  model.job.options.criterion = Tracking{gain};
  model.job.choose_criterion = false;
  model.fit = refit_from(model.job, values_of(model.fit), context);
  // Among narrow minima a quick fit may end for want of iterations.
  if (model.fit.verdict.kind == FitVerdict::Kind::no_minimum)
    model.fit = refit_from(model.job, values_of(model.fit), context);
  return model;
}

SearchState named(SearchState state, Rounds& rounds) {
  try {
    add_named(state, rounds);
  } catch (const Interrupted&) {
    state.interrupted = true;
  }
  return state;
}

SearchState together(SearchState state, Rounds& rounds) {
  find_together(state, rounds);
  return state;
}

SearchState with_curves(SearchState state, Rounds& rounds) {
  try {
    while (has_room(state, rounds) && add_best(state, true, rounds)) {
    }
  } catch (const Interrupted&) {
    state.interrupted = true;
  }
  return state;
}

SearchState from_a_curve(const SearchState& state, Rounds& rounds) {
  SearchState anew = state;
  anew.restart(state.chain.declared());
  if (!add_best(anew, true, rounds)) return state;
  add_named(anew, rounds);
  eliminate_backward(anew, rounds.context);
  return anew;
}

SearchState search(SearchState declared, Rounds& rounds) {
  const SearchOptions& options = rounds.context.options;
  // A simulation that tracks the data has seen what masks what; it also shows a curve beside
  // effects that imitate a part of it.
  const bool tracks = axisfit::tracks(declared.chain.declared().job.options.criterion);
  SearchState best = with_named_effects(declared, tracks, rounds);
  if (is_over(best) || is_fitted_to_noise(best) || is_left_by_a_curve(best, options) ||
      best.current().fit.reduced_chi_square < options.round.exact_mean_square)
    return best;
  // No curve takes the place of what leaves next to nothing.
  const bool is_little = has_left_little(best, options);

  const std::size_t names = best.accepted().size();
  best = with_curves(std::move(best), rounds);
  const bool has_curve = best.accepted().size() > names;
  if (best.interrupted || names == 0 || is_little || (tracks && !has_curve) ||
      !can_gain_by_a_curve(best, options) ||
      (!has_curve && !is_a_curve_in_reach(best, rounds.of_curves.list, options)))
    return best;
  SearchState other = finished(best, [&](const SearchState& s) { return from_a_curve(s, rounds); });
  if (other.interrupted || is_proven(other.current(), best.current(), has_curve, options))
    return other;
  return best;
}

}  // namespace axisfit
