#include "fit/search/select_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include "base/parallel.h"
#include "fit/criterion/windows.h"
#include "fit/estimate/horizon.h"
#include "fit/estimate/kalman_gain.h"
#include "fit/estimate/recipes.h"
#include "fit/search/pruning.h"
#include "fit/search/rivals.h"
#include "fit/search/round.h"
#include "fit/search/score.h"
#include "fit/search/verdict.h"
#include "fit/solve/parameters.h"

namespace axisfit {
namespace {

/// The model, refitted with a simulation that tracks the data.
SelectionStep tracking(SelectionStep model, double gain, const RunContext& context) {
  model.job.options.criterion = Tracking{gain};
  model.job.choose_criterion = false;
  model.fit = refit_from(model.job, values_of(model.fit), context);
  return model;
}

/// Fits with the full accuracy from close by.
FitResult final_fit(Job job, const std::vector<double>& values, const RunContext& context) {
  set_initial_values(job, values);
  job.options = recipe::final_fit(job);
  return estimate(job, context.quiet());
}

class EffectSelector {
 public:
  EffectSelector(const Job& job, const FitResult& first, const SelectionOptions& options,
                 const RunContext& context)
      : options_(options),
        first_(first),
        context_(context),
        state_{ModelChain({"", job, first}, context)} {
    if (std::ranges::none_of(job.recordings,
                             [](const Recording& r) { return r.role == Role::validate; })) {
      result_.held_out_blocks = true;
      chain().restart(with_held_out_blocks(chain().declared(), context));
    }
  }

  EffectSelection run() {
    last_valid_ = state_;
    if (current().fit.usable) {
      try {
        search();
        last_valid_ = state_;
        eliminate_backward(state_, context_);
        drop_imitators(state_, context_);
        drop_unreplicated_of_a_poor_model(state_, options_.least_share, context_);
        drop_other_periods(state_, context_);
        drop_all_of_a_misfit();
        find_equals();
        record_replications(state_, context_);
      } catch (const Interrupted&) {
        result_.interrupted = true;
        result_.rivals.clear();
        state_ = std::move(*last_valid_);
        if (const auto rejection = rejection_of_all(state_, options_.least_share))
          state_.take_out_all(*rejection);
        drop_all_of_a_misfit();
      }
    }
    finish();
    return std::move(result_);
  }

 private:
  ModelChain& chain() { return state_.chain; }
  const SelectionStep& current() const { return state_.current(); }
  const std::vector<AcceptedEffect>& accepted() const { return state_.accepted(); }
  const Job& declared_job() const { return state_.chain.declared().job; }
  bool explained() { return state_.chain.explained(); }

  /// Adds named effects as long as one passes. If they do not suffice, tries again while the
  /// simulation tracks the data, and then with a curve first: named effects may have imitated part
  /// of something that is in no catalogue.
  void search() {
    search_named();
    if (explained()) return;
    SearchState strict = state_;
    provisional_ = true;
    search_together(strict.chain.accepted());
    provisional_ = false;
    if (!is_better(current(), strict.chain.current())) state_ = std::move(strict);
    last_valid_ = state_;
    if (explained()) return;
    const SearchState named = state_;
    while (has_room() && round(true)) {
    }
    const SearchState appended = state_;
    const bool appends = accepted().size() > named.chain.accepted().size();
    // A simulation that tracks the data shows a curve also beside effects that imitate a part of
    // it.
    const bool tracks = axisfit::tracks(declared_job().options.criterion);
    if (named.chain.accepted().empty() || (tracks && !appends) || !can_gain_by_a_curve()) return;
    provisional_ = true;
    restart(chain().declared());
    if (!round(true)) {
      state_ = appended;
      return;
    }
    search_named();
    eliminate_backward(state_, context_);
    const SelectionStep& rival = appended.chain.current();
    const double loss = loss_of(rival, current());
    // A curve has a mean, too: what is not fitted must tell it from a named effect.
    const Improvement gain = improvement(rival, current());
    const bool is_proven = gain.comparable && gain.p_value < kChance;
    if (!is_proven || (loss > 0.0 && (appends || is_clearly_worse(loss)))) state_ = appended;
  }

  /// Whether a model with a curve in the place of the accepted effects could explain the recordings
  /// about as well, if it left nothing but noise.
  bool can_gain_by_a_curve() const {
    constexpr double kOfACurve = 14.0;  // coefficients, at least
    double more = kOfACurve;
    for (const AcceptedEffect& a : accepted())
      more -= static_cast<double>(a.candidate.parameters());
    return !is_clearly_worse(
        least_bic_difference(residual_series(current().job, current().fit), more));
  }

  /// By how much b explains the recordings worse than a, parameters counted.
  static double loss_of(const SelectionStep& a, const SelectionStep& b) {
    return bic_difference(residual_series(a.job, a.fit), a.job.free.size(),
                          residual_series(b.job, b.fit), b.job.free.size());
  }
  static bool is_better(const SelectionStep& a, const SelectionStep& b) {
    return a.fit.usable && is_clearly_worse(loss_of(a, b));
  }

  /// Several large effects mask each other: the free-running simulation drifts away from the data
  /// whichever of them is added, and its residual says little. A simulation that tracks the data
  /// stays near them. So the effects are found and judged while tracking, and then refitted
  /// together free-running. What else is missing counts as noise for each of them: they are judged
  /// leniently until all are known, and strictly by backward elimination. What is known already has
  /// been searched on from.
  void search_together(const std::vector<AcceptedEffect>& known) {
    constexpr double kProvisionalChance = 0.05;
    const SelectionStep declared = chain().declared();
    const bool is_continued = declared.job.options.is_continued();
    if (is_continued) restart(tracking(declared, score_gains(declared.job).front(), context_));
    while (current().fit.usable && has_room() && !explained() && round(false, kProvisionalChance)) {
    }
    const bool is_new = std::ranges::any_of(accepted(), [&](const AcceptedEffect& found) {
      return std::ranges::none_of(known, [&](const AcceptedEffect& other) {
        return same_effect(found.candidate, other.candidate);
      });
    });
    if (!is_new) return restart(declared);
    if (is_continued) {
      SelectionStep all = chain().with_accepted(declared.job);
      if (!all.fit.usable) return restart(declared);
      chain().replace(declared, std::move(all));
    }
    search_named();
    eliminate_backward(state_, context_);
  }
  bool has_room() const {
    return accepted().size() < static_cast<std::size_t>(options_.max_effects);
  }

  void search_named() {
    swapped_ = false;
    std::optional<Candidate> degenerate;
    do {
      while (has_room())
        if (!round(false) && !try_swap()) break;
      degenerate = drop_degenerate(state_);
      if (degenerate) degenerate_.push_back(*degenerate);
    } while (degenerate);
  }

  void restart(SelectionStep declared) {
    chain().restart(std::move(declared));
    state_.trials = {};
    degenerate_.clear();
  }

  /// Adds the effect that explains the most, if one passes. Returns whether one did.
  bool round(bool curves, double chance = kChance) {
    const auto begin = std::chrono::steady_clock::now();
    ++round_;
    const bool passed = add_best(curves, chance);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    context_.report({.phase = "search",
                     .best = current().fit.reduced_chi_square,
                     .finished = fmt::format("round {}, {:.1f} s: {}", round_, time.count(),
                                             passed ? current().added : "none")});
    return passed;
  }

  bool add_best(bool curves, double chance) {
    RoundResult found = try_round(current(),
                                  {.curves = curves,
                                   .shortlist = options_.shortlist,
                                   .chance = chance,
                                   .held_out_blocks = result_.held_out_blocks,
                                   .explained = explained(),
                                   .excluded = degenerate_},
                                  curves ? of_curves_ : of_names_, context_);
    tried_ = found.tried;
    ExtendedModel* best = found.best ? &found.models[*found.best] : nullptr;
    for (const ExtendedModel& e : found.models) state_.trials.record(e, best, round_);
    if (best == nullptr) {
      for (const ExtendedModel& e : found.models) note_relative(e);
      return false;
    }
    AcceptedEffect accepted{best->candidate, {}, best->replication || best->on_stretches};
    for (const ExtendedModel& e : found.models) {
      if (&e == best || !e.fit.usable || !e.gain.comparable) continue;
      // Rivals are seen again when all else is explained.
      if (is_clearly_worse(bic_advantage(*best, e))) continue;
      accepted.rivals.push_back({e.candidate, candidate_values(e.job, e.fit, e.candidate)});
    }
    // So are those of more parameters, which the rounds to come may tell from it.
    for (const ShortlistEntry& e : found.seconds)
      if (!same_effect(e.candidate, best->candidate) && !e.candidate.gives_backlash)
        accepted.rivals.push_back({e.candidate, {{}, e.score.shapes}});
    chain().append(std::move(accepted), std::move(best->job), std::move(best->fit));
    if (!provisional_) last_valid_ = state_;
    return true;
  }

  /// What gains beside an accepted effect of its kind, and only there, may be what that imitates:
  /// it becomes its rival.
  void note_relative(const ExtendedModel& e) {
    using enum Rejection::Test;
    constexpr std::array kOfValidation{validation, power, validation_size};
    if (e.candidate.is_constant || !e.rejection ||
        std::ranges::find(kOfValidation, e.rejection->test) == kOfValidation.end())
      return;
    for (AcceptedEffect& accepted : chain().accepted()) {
      const auto is_known = [&](const Rival& r) { return same_effect(r.candidate, e.candidate); };
      if (accepted.candidate.acts_on == e.candidate.acts_on &&
          std::ranges::none_of(accepted.rivals, is_known))
        accepted.rivals.push_back({e.candidate, candidate_values(e.job, e.fit, e.candidate)});
    }
  }

  /// Exchanges the first accepted effect that has a clearly better rival.
  bool try_swap() {
    if (accepted().empty() || swapped_) return false;
    swapped_ = true;
    std::optional<Exchange> found = better_rival(state_, tried_, context_);
    if (!found) return false;
    ExtendedModel& better = found->with_other;
    state_.trials.reject(accepted()[found->place].candidate, Reason::replaced,
                         better.candidate.name);
    state_.trials.record(better, &better, round_);
    // The exchanged effect goes last, where its parameters are.
    state_.strike_off(found->place);
    chain().accepted().push_back({better.candidate, {}});
    chain().set_last({better.candidate.name, std::move(better.job), std::move(better.fit)});
    return true;
  }

  void drop_all_of_a_misfit() {
    if (!explained() && is_misfit(state_, result_.verdict))
      state_.take_out_all({.test = Rejection::Test::misfit});
  }

  /// An effect that has an equal is not accepted, for it may be the other. But without either, all
  /// that is estimated pays for it: it stays in the model. Which of two clocks is off matters
  /// little: there the chosen one is accepted, and the other named beside it.
  void find_equals() {
    const Model<double> with_chosen = fitted_model(current().job, current().fit);
    for (const RivalPair& pair : equal_rivals(state_, round_, context_)) {
      const Candidate& chosen = accepted()[pair.place].candidate;
      result_.rivals.push_back({chosen.name, pair.rival.name, with_chosen, pair.model});
      if (pair.are_delays)
        state_.trials.reject(pair.rival, Reason::explains_equally, chosen.name);
      else
        state_.trials.leave_undecided(chosen, pair.rival);
    }
  }

  void finish();
  void propose_closed_forms();
  std::vector<std::string> small_effects() const;

  const SelectionOptions options_;
  const FitResult& first_;
  const RunContext& context_;
  EffectSelection result_;
  SearchState state_;
  std::optional<SearchState> last_valid_;  ///< the latest state that can be a result
  bool provisional_ = false;               ///< what is accepted has yet to prove better than that
  std::vector<Candidate> degenerate_;      ///< not to be tried again
  std::size_t tried_ = 1;
  RoundMemory of_names_, of_curves_;
  int round_ = 0;
  bool swapped_ = false;
};

void EffectSelector::finish() {
  result_.verdict.small = small_effects();
  const bool is_noise = current().fit.usable && explained();
  result_.explained = is_noise && result_.verdict.small.empty();
  result_.result = current();
  // The refits on the way were content with less, and blocks that were held out count too.
  SelectionStep& last = result_.result;
  for (Recording& r : last.job.recordings) r.held_out.clear();
  if (accepted().empty()) {
    last.fit = first_;
  } else if (!result_.interrupted) {
    state_.report_progress(context_, "final fit");
    try {
      FitResult exact = final_fit(last.job, values_of(last.fit), context_);
      if (exact.usable) last.fit = std::move(exact);
    } catch (const Interrupted&) {
      result_.interrupted = true;
    }
  }
  try {
    propose_closed_forms();
    result_.models = chain().models();
  } catch (const Interrupted&) {
    result_.interrupted = true;
    result_.models = {chain().declared(), current()};
  }
  if (chain().declared().fit.usable) {
    enter_effects(state_, result_.result, result_.verdict);
    result_.verdict.kind = kind_of(result_, is_noise);
  }
  result_.effects = state_.trials.list();
}

/// For accepted curves, where they pass the test of the curve.
void EffectSelector::propose_closed_forms() {
  for (std::size_t a = 0; a < accepted().size(); ++a) {
    const Candidate& curve = accepted()[a].candidate;
    EffectTrial* trial = state_.trials.find(curve);
    if (trial == nullptr || !curve.is_curve) continue;
    auto form = closed_form(result_.result.job, result_.result.fit, curve);
    if (form && is_confirmed(*form, curve, current(), chain().without(a), context_))
      trial->closed_form = std::move(form);
  }
}

/// Effects that were rejected for their size alone, in the last round.
std::vector<std::string> EffectSelector::small_effects() const {
  std::vector<std::string> names;
  for (const EffectTrial& t : state_.trials.list())
    if (t.round == round_ && t.rejection && t.rejection->test == Rejection::Test::validation_size)
      names.push_back(t.candidate.name);
  return names;
}

/// What was found by another criterion, with the fits that this one asks for, which was or was not
/// chosen. Of the declared model such a fit may be known.
EffectSelection refitted(EffectSelection selection, const Criterion& criterion, bool is_chosen,
                         const FitResult* declared, const RunContext& context) {
  const auto take_criterion = [&](Job& job) {
    job.options.criterion = criterion;
    job.choose_criterion = is_chosen;
  };
  std::vector<SelectionStep>& models = selection.models;
  SelectionStep& last = selection.result;
  take_criterion(last.job);
  context.report({.phase = "final fit"});
  last.fit = models.size() > 1 ? final_fit(last.job, values_of(last.fit), context) : *declared;
  for (SelectionStep& model : models) {
    take_criterion(model.job);
    // Where blocks are held out, they are left out of these fits alone.
    const bool is_known = !selection.held_out_blocks;
    if (is_known && declared != nullptr && &model == &models.front()) {
      model.fit = *declared;
    } else if (is_known && &model == &models.back()) {
      model.fit = last.fit;
    } else {
      context.report({.phase = model.added.empty() ? "fitting" : "fitting with " + model.added});
      model.fit = refit_from(model.job, values_of(model.fit), context);
    }
  }
  SelectionVerdict& verdict = selection.verdict;
  if (models.size() > 1)
    verdict.validate_percent = improvement(models.front(), models.back()).validate_percent;
  // Windows, and a gain that follows the noise, show less than the search has seen.
  const bool was_noise =
      selection.explained || verdict.kind == SelectionVerdict::Kind::hardly_anything;
  const bool is_noise = was_noise && last.fit.usable && explains(last);
  selection.explained = is_noise && verdict.small.empty();
  if (verdict.kind != SelectionVerdict::Kind::no_usable_fit)
    verdict.kind = kind_of(selection, is_noise);
  return selection;
}

}  // namespace

EffectSelection select_effects(const Job& job, const FitResult& first,
                               const SelectionOptions& options, const RunContext& context) {
  const ThreadPool pool(job.options.threads);
  const SelectionStep declared{"", job, first};
  const bool is_chosen = job.choose_criterion;
  std::optional<double> least_gain = quiet_gain(job, first);
  const bool is_moved = least_gain.has_value();
  // The states with which windows begin take part of what is missing upon themselves, and every
  // fit with them takes minutes. A simulation that was chosen to track may follow the noise.
  const bool tracks = first.usable && (window_states(job) > 0 || is_moved ||
                                       (is_chosen && axisfit::tracks(job.options.criterion)));
  // Nor at a gain at which noise of the inputs adds up.
  if (tracks && !is_moved) least_gain = kalman_gain(job, values_of(first));
  const SelectionStep start =
      tracks ? tracking(declared, std::max(score_gains(job).front(), least_gain.value_or(0.0)),
                        context)
             : declared;
  EffectSelection selection = EffectSelector(start.job, start.fit, options, context).run();
  try {
    Criterion criterion = job.options.criterion;
    // What predicts best changes with the model.
    if (is_chosen && !selection.interrupted && selection.models.size() > 1) {
      Job extended = selection.result.job;
      extended.options = job.options;
      set_initial_values(extended, values_of(selection.result.fit));
      try {
        selection.horizon = choose_horizon(extended, context);
        criterion = selection.horizon->best().criterion;
      } catch (const NoHorizon&) {
        // The one that was chosen for the declared model stays.
      }
    }
    // A free run that noise moves would not keep what was found.
    if (is_moved && !is_chosen && selection.models.size() > 1) return selection;
    const bool is_other = criterion != job.options.criterion;
    if (!selection.interrupted && (tracks || is_other))
      selection = refitted(selection, criterion, is_chosen, is_other ? nullptr : &first, context);
  } catch (const Interrupted&) {
    selection.interrupted = true;
  }
  return selection;
}

}  // namespace axisfit
