#include "fit/search/select_effects.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "fit/criterion/gains.h"
#include "fit/criterion/windows.h"
#include "fit/estimate/horizon.h"
#include "fit/estimate/kalman_gain.h"
#include "fit/estimate/recipes.h"
#include "fit/search/pruning.h"
#include "fit/search/rivals.h"
#include "fit/search/strategies.h"
#include "fit/search/verdict.h"
#include "fit/solve/parameters.h"

namespace axisfit {
namespace {

/// The declared model as a search begins with it: fitted to blocks where no recording validates.
SearchState begin(const Job& job, const FitResult& first, Rounds& rounds) {
  SearchState state{ModelChain({"", job, first}, rounds.context)};
  if (rounds.free) state.chain.set_free(rounds.free->job);
  rounds.held_out_blocks = std::ranges::none_of(
      job.recordings, [](const Recording& r) { return r.role == Role::validate; });
  if (rounds.held_out_blocks)
    state.restart(with_held_out_blocks(state.chain.declared(), rounds.context));
  return state;
}

void drop_all_of_a_misfit(SearchState& state, SelectionVerdict& verdict) {
  if (!state.explained() && is_misfit(state, verdict))
    state.take_out_all({.test = Rejection::Test::misfit});
}

/// A plain law that does as well takes the place of the first effect that it is an equal of;
/// whether there was one.
bool exchange_for_plain(SearchState& state, std::vector<TriedRival>& equals, int round) {
  const auto plain = std::ranges::find_if(equals, [&](const TriedRival& rival) {
    return is_plain_beside(rival.tried.hypothesis, state.accepted()[rival.place].hypothesis);
  });
  if (plain == equals.end()) return false;
  state.outcomes.reject(state.accepted()[plain->place].hypothesis, Reason::explains_less,
                        plain->tried.hypothesis.name);
  state.exchange(plain->place, std::move(plain->tried), round);
  return true;
}

/// An effect that has an equal is not accepted, for it may be the other. But without either, all
/// that is estimated pays for it: it stays in the model. Which of two clocks is off matters
/// little: there the chosen one is accepted, and the other named beside it.
std::vector<Substitution> find_equals(SearchState& state, const Rounds& rounds) {
  std::vector<TriedRival> equals;
  do {
    equals = equal_rivals(state, rounds.count, rounds.context);
  } while (exchange_for_plain(state, equals, rounds.count));
  std::vector<Substitution> found;
  const Model<double> with_chosen = fitted_model(state.current().job, state.current().fit);
  for (const auto& [place, tried] : equals) {
    const Hypothesis& chosen = state.accepted()[place].hypothesis;
    found.push_back(
        {chosen.name, tried.hypothesis.name, with_chosen, fitted_model(tried.job, tried.fit)});
    if (are_delays(chosen, tried.hypothesis))
      state.outcomes.reject(tried.hypothesis, Reason::is_equal_delay, chosen.name);
    else
      state.outcomes.leave_undecided(chosen, tried.hypothesis);
  }
  return found;
}

/// Takes away again what does not stand beside all else, and looks for equals of the rest. Throws
/// Interrupted.
void review(SearchState& state, const Rounds& rounds, EffectSelection& selection) {
  eliminate_backward(state, rounds.context);
  drop_imitators(state, rounds.context);
  drop_unreplicated_of_a_poor_model(state, rounds.context);
  drop_other_periods(state, rounds.context);
  name_as_first(state, rounds.context);
  drop_all_of_a_misfit(state, selection.verdict);
  selection.substitutions = find_equals(state, rounds);
  record_replications(state, rounds.context);
}

/// A search that was stopped names no effects that together take too little of the error away.
void review_stopped(SearchState& state, const Rounds& rounds, EffectSelection& selection) {
  selection.interrupted = true;
  selection.substitutions.clear();
  try {
    if (const auto rejection = rejection_of_all(state, rounds.context.options))
      state.take_out_all(*rejection);
    drop_all_of_a_misfit(state, selection.verdict);
  } catch (const Interrupted&) {  // whether the model explains everything takes fits to tell
  }
}

/// Effects that were rejected for their size alone, in the last round.
std::vector<std::string> small_effects(const SearchState& state, const Rounds& rounds) {
  std::vector<std::string> names;
  for (const Outcome& o : state.outcomes.list())
    if (o.round == rounds.count && o.rejection &&
        o.rejection->test == Rejection::Test::validation_size)
      names.push_back(o.hypothesis.name);
  return names;
}

/// The last model with the accuracy of a final fit, which the refits on the way had not, and fitted
/// to blocks that were held out, too.
FittedModel final_model(const SearchState& state, const FitResult& first, const Rounds& rounds,
                        bool& interrupted) {
  FittedModel last = state.current();
  for (Recording& r : last.job.recordings) r.held_out.clear();
  if (state.accepted().empty()) {
    last.fit = first;
  } else if (!interrupted) {
    state.report_progress(rounds.context.run, "final fit", Work::fits);
    try {
      FitResult exact = final_fit(last.job, values_of(last.fit), rounds.context);
      if (exact.is_usable()) last.fit = std::move(exact);
    } catch (const Interrupted&) {
      interrupted = true;
    }
  }
  return last;
}

/// Those of effects that were taken out tell nothing.
void keep_substitutions_of(const SearchState& state, EffectSelection& selection) {
  std::erase_if(selection.substitutions, [&](const Substitution& s) {
    return std::ranges::none_of(state.accepted(),
                                [&](const Accepted& a) { return a.hypothesis.name == s.chosen; });
  });
}

/// The final model, without the effects that it leaves open.
FittedModel determined_model(SearchState& state, const FitResult& first, const Rounds& rounds,
                             EffectSelection& selection) {
  FittedModel last = final_model(state, first, rounds, selection.interrupted);
  try {
    while (!selection.interrupted && drop_undetermined(state, last, rounds.context)) {
      name_as_first(state, rounds.context);
      last = final_model(state, first, rounds, selection.interrupted);
      keep_substitutions_of(state, selection);
    }
  } catch (const Interrupted&) {
    selection.interrupted = true;
  }
  return last;
}

/// For accepted curves, where they pass the test of the curve.
void propose_closed_forms(SearchState& state, const FittedModel& last,
                          const SearchContext& context) {
  for (std::size_t a = 0; a < state.accepted().size(); ++a) {
    const Hypothesis& curve = state.accepted()[a].hypothesis;
    Outcome* outcome = state.outcomes.find(curve);
    if (outcome == nullptr || curve.kind != HypothesisKind::curve) continue;
    auto form = closed_form(last.job, last.fit, curve);
    if (form && is_confirmed(*form, curve, state.current(), state.chain.without(a), context))
      outcome->closed_form = std::move(form);
  }
}

/// As search(), until there is only time left to judge what it found.
SearchState searched(SearchState declared, Rounds& rounds) {
  RunContext& context = rounds.context.run;
  const StopFlag* const stop = context.stop;
  if (context.end_search != nullptr) context.stop = context.end_search;
  SearchState found = declared;
  try {
    found = search(std::move(declared), rounds);
  } catch (const Interrupted&) {
    found.interrupted = true;
  }
  context.stop = stop;
  return found;
}

/// A whole search by the criterion of the job.
EffectSelection search_effects(const Job& job, const FitResult& first, Rounds& rounds) {
  EffectSelection selection;
  SearchState state = begin(job, first, rounds);
  selection.held_out_blocks = rounds.held_out_blocks;
  if (state.current().fit.is_usable()) {
    state = searched(std::move(state), rounds);
    const SearchState found = state;
    selection.cut_short = state.interrupted && !is_set(rounds.context.run.stop);
    try {
      if (state.interrupted && !selection.cut_short) throw Interrupted();
      review(state, rounds, selection);
    } catch (const Interrupted&) {
      state = found;
      review_stopped(state, rounds, selection);
    }
  }
  selection.result = determined_model(state, first, rounds, selection);
  selection.verdict.small = small_effects(state, rounds);
  const bool is_noise = selection.result.fit.is_usable() && explains(selection.result);
  selection.explained = is_noise && selection.verdict.small.empty();
  try {
    propose_closed_forms(state, selection.result, rounds.context);
    selection.models = state.chain.models();
  } catch (const Interrupted&) {
    selection.interrupted = true;
    selection.models = {state.chain.declared(), state.current()};
  }
  if (state.current().fit.is_usable()) {
    enter_effects(state, selection.result, selection.verdict);
    selection.verdict.kind = kind_of(selection, is_noise);
  }
  selection.effects = state.outcomes.list();
  return selection;
}

/// Takes out what the fits by another criterion than that of the search leave open. Throws
/// Interrupted.
void drop_what_is_open(EffectSelection& selection, const SearchContext& context) {
  SearchState state{ModelChain(selection.models.front(), context), Outcomes(selection.effects)};
  for (const FittedModel& model : std::span(selection.models).subspan(1)) {
    const auto outcome = std::ranges::find_if(selection.effects, [&](const Outcome& o) {
      return o.in_model && o.hypothesis.name == model.added;
    });
    if (outcome == selection.effects.end()) return;
    state.chain.append({outcome->hypothesis}, model.job, model.fit);
  }
  const std::size_t all = state.accepted().size();
  FittedModel& last = selection.result;
  while (drop_undetermined(state, last, context)) {
    last = state.current();
    last.fit = final_fit(last.job, values_of(last.fit), context);
  }
  if (state.accepted().size() == all) return;
  selection.models = state.chain.models();
  selection.models.back().fit = last.fit;
  selection.effects = state.outcomes.list();
  keep_substitutions_of(state, selection);
  SelectionVerdict& verdict = selection.verdict;
  verdict.accepted.clear();
  verdict.undecided.clear();
  verdict.corrections.clear();
  enter_effects(state, last, verdict);
}

/// What was found by another criterion, with the fits that this one asks for, which was or was not
/// chosen. Such a fit of the declared model may be known.
EffectSelection with_criterion(EffectSelection selection, const Criterion& criterion,
                               bool is_chosen, const FitResult* declared,
                               const SearchContext& context) {
  const auto take_criterion = [&](Job& job) {
    job.options.criterion = criterion;
    job.choose_criterion = is_chosen;
  };
  std::vector<FittedModel>& models = selection.models;
  FittedModel& last = selection.result;
  take_criterion(last.job);
  context.run.report({.phase = "final fit"});
  last.fit = models.size() > 1 ? final_fit(last.job, values_of(last.fit), context) : *declared;
  for (FittedModel& model : models) {
    take_criterion(model.job);
    // Where blocks are held out, they are left out of these fits alone.
    const bool is_known = !selection.held_out_blocks;
    if (is_known && declared != nullptr && &model == &models.front()) {
      model.fit = *declared;
    } else if (is_known && &model == &models.back()) {
      model.fit = last.fit;
    } else {
      context.run.report(
          {.phase = model.added.empty() ? "fitting" : "fitting with " + model.added});
      model.fit = refit_from(model.job, values_of(model.fit), context);
    }
  }
  if (models.size() > 1) drop_what_is_open(selection, context);
  SelectionVerdict& verdict = selection.verdict;
  if (models.size() > 1)
    verdict.validate_percent = improvement(models.front(), models.back()).validate_percent;
  // Windows, and a gain that follows the noise, show less than the search has seen.
  const bool was_noise =
      selection.explained || verdict.kind == SelectionVerdict::Kind::hardly_anything;
  const bool is_noise = was_noise && last.fit.is_usable() && explains(last);
  selection.explained = is_noise && verdict.small.empty();
  if (verdict.kind != SelectionVerdict::Kind::no_usable_fit)
    verdict.kind = kind_of(selection, is_noise);
  return selection;
}

/// What a search begins with.
struct Start {
  FittedModel model;
  bool tracks = false;          ///< though the job may ask for something else
  bool input_is_noisy = false;  ///< and moves a free run by more than the readings are in doubt
};

/// The declared model, tracked where its own fit would hide effects or take minutes: the states
/// with which windows begin take part of what is missing upon themselves, a free run that noise of
/// the input moves is elsewhere, what the model lacks may leave it without a minimum, and a
/// simulation that was chosen to track may follow the noise. The gain is one at which noise of the
/// inputs does not add up.
Start start_of(const Job& job, const FitResult& first, const SearchContext& context) {
  Start start{{"", job, first}};
  std::optional<double> least_gain = quiet_gain(job, first);
  start.input_is_noisy = least_gain.has_value();
  const bool was_chosen_to_track = job.choose_criterion && tracks(job.options.criterion);
  start.tracks = first.verdict.kind == FitVerdict::Kind::no_minimum ||
                 (first.is_usable() && (window_length(job.options.criterion) > 0.0 ||
                                        start.input_is_noisy || was_chosen_to_track));
  if (!start.tracks) return start;
  if (!least_gain) least_gain = kalman_gain(job, values_of(first));
  start.model = tracking(std::move(start.model),
                         std::max(search_gain(job), least_gain.value_or(0.0)), context);
  return start;
}

/// The criterion for the model with the effects that were found: what predicts best changes with
/// the model. Throws Interrupted.
Criterion chosen_criterion(const Job& job, EffectSelection& selection, const RunContext& context) {
  Job extended = selection.result.job;
  extended.options = job.options;
  set_initial_values(extended, values_of(selection.result.fit));
  try {
    selection.horizon = choose_horizon(extended, context);
    return selection.horizon->best().criterion;
  } catch (const NoHorizon&) {
    return job.options.criterion;  // that which was chosen for the declared model stays
  }
}

}  // namespace

EffectSelection select_effects(const Job& job, const FitResult& first, const SearchOptions& options,
                               const RunContext& context) {
  const ThreadPool pool(job.options.threads);
  Rounds rounds{.context = {options, context}};
  const Start start = start_of(job, first, rounds.context);
  if (start.tracks && !start.input_is_noisy && !job.choose_criterion &&
      std::holds_alternative<FreeRun>(job.options.criterion))
    rounds.free = {"", job, first};
  EffectSelection selection = search_effects(start.model.job, start.model.fit, rounds);
  const bool found_any = selection.models.size() > 1;
  if (selection.interrupted) return selection;
  try {
    const Criterion criterion = job.choose_criterion && found_any
                                    ? chosen_criterion(job, selection, context)
                                    : job.options.criterion;
    // A free run that noise moves would not keep what was found.
    if (start.input_is_noisy && !job.choose_criterion && found_any) return selection;
    const bool is_other = criterion != job.options.criterion;
    // A search that came to its end in time left a model that tracks.
    const bool still_tracks =
        selection.result.job.options.criterion != start.model.job.options.criterion;
    if (start.tracks || is_other || still_tracks)
      selection = with_criterion(selection, criterion, job.choose_criterion,
                                 is_other ? nullptr : &first, rounds.context);
  } catch (const Interrupted&) {
    selection.interrupted = true;
  }
  return selection;
}

}  // namespace axisfit
