#include "fit/selection/select_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <optional>
#include <set>

#include "base/parallel.h"
#include "fit/estimation/parameters.h"
#include "fit/estimation/windows.h"
#include "fit/residuals/missing_force.h"
#include "fit/selection/alternatives.h"
#include "fit/selection/grade.h"
#include "fit/selection/round.h"
#include "fit/selection/score.h"

namespace axisfit {
namespace {

/// The model, refitted with a simulation that tracks the data.
SelectionStep tracking(SelectionStep model, const RunContext& context) {
  FitOptions& options = model.job.options;
  const double gain = score_gains(model.job).front();
  options.observer = ObserverMode::fixed;
  options.observer_gain = gain;
  options.horizon = 0.0;
  model.fit = refit_from(model.job, values_of(model.fit), context);
  return model;
}

/// Fits with the full accuracy from close by.
FitResult final_fit(Job job, const std::vector<double>& values, const RunContext& context) {
  set_initial_values(job, values);
  job.options.starts = 1;
  job.options.attempts = 1;
  if (job.options.observer == ObserverMode::continuation)
    job.options.observer_gain = score_gains(job).back();
  return estimate(job, context.quiet());
}

class EffectSelector {
 public:
  EffectSelector(const Job& job, const FitResult& first, const SelectionOptions& options,
                 const RunContext& context)
      : options_(options), first_(first), context_(context), chain_({"", job, first}, context) {
    if (std::ranges::none_of(job.recordings,
                             [](const Recording& r) { return r.role == Role::validate; })) {
      result_.held_out_blocks = true;
      chain_.restart(with_held_out_blocks(chain_.declared(), context));
    }
  }

  EffectSelection run() {
    last_valid_ = snapshot();
    if (current().fit.usable) {
      try {
        search();
        last_valid_ = snapshot();
        eliminate_backward();
        drop_imitators();
        record_rivals();
        drop_undecided();
        drop_unreplicated_where_half_remains();
        drop_other_periods();
        record_replications();
      } catch (const Interrupted&) {
        result_.interrupted = true;
        restore(std::move(*last_valid_));
        if (const auto rejection = rejection_of_all()) drop_all(*rejection);
      }
      drop_all_of_a_misfit();
    }
    finish();
    return std::move(result_);
  }

 private:
  /// An accepted effect (its place) and another that explains the data as well.
  struct RivalPair {
    std::size_t place = 0;
    Candidate rival;
    Model<double> model;  ///< fitted with the rival in its place
  };

  /// Where a search stands.
  struct SearchState {
    ModelChain chain;
    Trials trials;
  };

  const SelectionStep& current() const { return chain_.current(); }
  const Job& declared_job() const { return chain_.declared().job; }
  bool explained() { return chain_.explained(); }

  /// Adds named effects as long as one passes. If they do not suffice, tries again while the
  /// simulation tracks the data, and then with a curve first: named effects may have imitated part
  /// of something that is in no catalogue.
  void search() {
    search_named();
    if (explained()) return;
    SearchState strict = snapshot();
    provisional_ = true;
    search_together(strict.chain.accepted());
    provisional_ = false;
    if (!is_better(current(), strict.chain.current())) restore(std::move(strict));
    last_valid_ = snapshot();
    if (explained()) return;
    const SearchState named = snapshot();
    while (has_room() && round(true)) {
    }
    const SearchState appended = snapshot();
    const bool appends = chain_.accepted().size() > named.chain.accepted().size();
    // A simulation that tracks the data shows a curve also beside effects that imitate a part of
    // it.
    const bool tracks = declared_job().options.observer == ObserverMode::fixed;
    if (named.chain.accepted().empty() || (tracks && !appends) || !can_gain_by_a_curve()) return;
    provisional_ = true;
    restart(chain_.declared());
    if (!round(true)) return restore(appended);
    search_named();
    eliminate_backward();
    const SelectionStep& rival = appended.chain.current();
    const double loss = loss_of(rival, current());
    // A curve has a mean, too: what is not fitted must tell it from a named effect.
    const Improvement gain = improvement(residual_series(rival.job, rival.fit),
                                         residual_series(current().job, current().fit));
    const bool is_proven = gain.comparable && gain.p_value < kChance;
    if (!is_proven || (loss > 0.0 && (appends || is_clearly_worse(loss)))) restore(appended);
  }

  /// Whether a model with a curve in the place of the accepted effects could explain the recordings
  /// about as well, if it left nothing but noise.
  bool can_gain_by_a_curve() const {
    constexpr double kOfACurve = 14.0;  // coefficients, at least
    double more = kOfACurve;
    for (const AcceptedEffect& a : chain_.accepted())
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
    const SelectionStep declared = chain_.declared();
    const bool is_continued = declared.job.options.observer == ObserverMode::continuation;
    if (is_continued) restart(tracking(declared, context_));
    while (current().fit.usable && has_room() && !explained() && round(false, kProvisionalChance)) {
    }
    const bool is_new = std::ranges::any_of(chain_.accepted(), [&](const AcceptedEffect& found) {
      return std::ranges::none_of(known, [&](const AcceptedEffect& other) {
        return same_effect(found.candidate, other.candidate);
      });
    });
    if (!is_new) return restart(declared);
    if (is_continued) {
      SelectionStep all = chain_.with_accepted(declared.job);
      if (!all.fit.usable) return restart(declared);
      chain_.replace(declared, std::move(all));
    }
    search_named();
    eliminate_backward();
  }
  bool has_room() const {
    return chain_.accepted().size() < static_cast<std::size_t>(options_.max_effects);
  }

  void search_named() {
    swapped_ = false;
    do {
      while (has_room())
        if (!round(false) && !try_swap()) break;
    } while (drop_degenerate());
  }

  /// Takes out what has become a simpler effect beside those accepted after it, and does not try it
  /// again: the simpler one is in the catalogue. Returns whether there was one.
  bool drop_degenerate() {
    for (std::size_t a = 0; a < chain_.accepted().size(); ++a) {
      const Candidate candidate = chain_.accepted()[a].candidate;
      const std::string shape = shape_at_bound(current().job, current().fit, candidate);
      if (shape.empty()) continue;
      const SelectionStep& reduced = chain_.without(a);
      if (!reduced.fit.usable) continue;
      trials_.fail(candidate, {.test = Rejection::Test::bound, .parameter = shape});
      degenerate_.push_back(candidate);
      take_out(a, reduced);
      return true;
    }
    return false;
  }

  SearchState snapshot() const { return {chain_, trials_}; }
  void restore(SearchState state) {
    chain_ = std::move(state.chain);
    trials_ = std::move(state.trials);
  }
  void restart(SelectionStep declared) {
    chain_.restart(std::move(declared));
    trials_ = {};
    degenerate_.clear();
  }

  void report_progress(const std::string& phase, int done = 0, int of = 0) {
    if (context_.progress) context_.progress({phase, done, of, current().fit.reduced_chi_square});
  }

  /// Adds the effect that explains the most, if one passes. Returns whether one did.
  bool round(bool curves, double chance = kChance) {
    const auto begin = std::chrono::steady_clock::now();
    ++round_;
    const bool passed = add_best(curves, chance);
    if (context_.progress) {
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
      context_.progress({.phase = "search",
                         .best = current().fit.reduced_chi_square,
                         .finished = fmt::format("round {}, {:.1f} s: {}", round_, time.count(),
                                                 passed ? current().added : "none")});
    }
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
    for (const ExtendedModel& e : found.models) trials_.record(e, best, round_);
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
    chain_.append(std::move(accepted), std::move(best->job), std::move(best->fit));
    if (!provisional_) last_valid_ = snapshot();
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
    for (AcceptedEffect& accepted : chain_.accepted()) {
      const auto is_known = [&](const Rival& r) { return same_effect(r.candidate, e.candidate); };
      if (accepted.candidate.acts_on == e.candidate.acts_on &&
          std::ranges::none_of(accepted.rivals, is_known))
        accepted.rivals.push_back({e.candidate, candidate_values(e.job, e.fit, e.candidate)});
    }
  }

  /// Strikes an accepted effect off, for what its trial says already, and what is part of it.
  void strike_off(std::size_t place) {
    for (const Candidate& part : chain_.erase(place)) trials_.reject(part, Reason::not_needed);
  }
  /// Takes it out of the models; that without it is given.
  void take_out(std::size_t place, SelectionStep reduced) {
    strike_off(place);
    chain_.set_last(std::move(reduced));
  }

  /// Takes away what is not needed any more, or never was but to a simulation that tracks. Where
  /// the fit stays far from the noise, what the recordings to validate tell alike beside all other
  /// effects is needed.
  void eliminate_backward() {
    const auto& accepted = chain_.accepted();
    bool is_far = !explained();
    const auto is_plain = [&](const AcceptedEffect& effect) {
      return is_far && is_alike_elsewhere(effect.candidate);
    };
    for (std::size_t a = 0; a < accepted.size();) {
      const Candidate& candidate = accepted[a].candidate;
      if (is_plain(accepted[a])) {
        ++a;
        continue;
      }
      report_progress("is " + candidate.name + " necessary?");
      std::vector<std::size_t> doubted;
      for (std::size_t b = a; b < accepted.size(); ++b)
        if (!is_plain(accepted[b])) doubted.push_back(b);
      chain_.fit_without(doubted);
      const SelectionStep& reduced = chain_.without(a);
      const Improvement gain = improvement(residual_series(reduced.job, reduced.fit),
                                           residual_series(current().job, current().fit));
      if (!reduced.fit.usable ||
          is_needed(gain, candidate.parameters(), accepted[a].is_seen_elsewhere)) {
        ++a;
        continue;
      }
      trials_.reject(candidate, Reason::not_needed);
      take_out(a, reduced);
      is_far = !explained();
      a = 0;
    }
  }

  /// Where the fit stays far from the noise, a flexible effect lowers every error a little,
  /// whatever is missing: named is only what accounts for a good part of it, or what other
  /// recordings show alike.
  void drop_imitators() {
    constexpr double kLeastPercent = 25.0;
    const auto& accepted = chain_.accepted();
    while (!accepted.empty() && !explained()) {
      const auto now = residual_series(current().job, current().fit);
      std::optional<std::size_t> least;
      double percent = kLeastPercent;
      for (std::size_t a = 0; a < accepted.size(); ++a) {
        const Candidate& candidate = accepted[a].candidate;
        if (candidate.is_curve || is_alike_elsewhere(candidate)) continue;
        report_progress("what does " + candidate.name + " explain?");
        const SelectionStep& reduced = chain_.without(a);
        const Improvement gain = improvement(residual_series(reduced.job, reduced.fit), now);
        if (!reduced.fit.usable || gain.missing_percent >= percent) continue;
        percent = gain.missing_percent;
        least = a;
      }
      if (!least) return;
      trials_.fail(accepted[*least].candidate, {.test = Rejection::Test::share, .found = percent});
      take_out(*least, chain_.without(*least));
    }
  }

  const std::optional<FitResult>& elsewhere() {
    if (!chain_.has_elsewhere()) report_progress("do the recordings to validate tell the same?");
    return chain_.elsewhere();
  }
  /// What the recordings to validate, fitted by themselves, say of an effect; nothing where they
  /// cannot be.
  std::optional<Replication> found_elsewhere(const Candidate& candidate) {
    const std::optional<FitResult>& other = elsewhere();
    if (!other) return std::nullopt;
    return replication(current().job, current().fit, *other, candidate);
  }
  bool is_alike_elsewhere(const Candidate& candidate) {
    const auto found = found_elsewhere(candidate);
    return found && found->is_alike;
  }

  /// What the recordings to validate, fitted by themselves, say of what was accepted.
  void record_replications() {
    for (const AcceptedEffect& a : chain_.accepted())
      if (EffectTrial* trial = trials_.find(a.candidate))
        if (auto found = found_elsewhere(a.candidate)) trial->replication = std::move(found);
  }

  /// Of a model with which most of the error remains, no part is named but what other recordings
  /// show alike; and no instrument, which takes the blame for a part of the machine in all alike.
  void drop_unreplicated_where_half_remains() {
    const std::optional<Rejection> rejection = rejection_of_all();
    for (std::size_t a = 0; rejection && a < chain_.accepted().size();) {
      const Candidate candidate = chain_.accepted()[a].candidate;
      if (!candidate.is_instrument() && is_alike_elsewhere(candidate)) {
        ++a;
        continue;
      }
      trials_.fail(candidate, *rejection);
      take_out(a, chain_.without(a));
    }
  }
  std::optional<Rejection> rejection_of_all() {
    constexpr double kLeastPercent = 50.0;
    if (chain_.accepted().empty() || explained()) return std::nullopt;
    const double percent = of_all().missing_percent;
    if (percent >= kLeastPercent) return std::nullopt;
    return Rejection{.test = Rejection::Test::share, .found = percent};
  }

  /// A period is what an effect with a phase is known by.
  void drop_other_periods() {
    for (std::size_t a = 0; a < chain_.accepted().size();) {
      const Candidate candidate = chain_.accepted()[a].candidate;
      const auto found = candidate.has_phase ? found_elsewhere(candidate) : std::nullopt;
      if (!found || !found->has_other_period) {
        ++a;
        continue;
      }
      trials_.fail(candidate,
                   {.test = Rejection::Test::period, .found = found->parameters.back().value});
      take_out(a, chain_.without(a));
    }
  }

  /// A declared parameter at its bound makes up for what it is not, and where most of the drive
  /// force is missing the simulation is elsewhere: effects then imitate what is wrong with the
  /// model.
  void drop_all_of_a_misfit() {
    if (explained()) return;
    SelectionVerdict& verdict = result_.verdict;
    const SelectionStep& last = current();
    for (std::size_t i = 0; i < declared_job().free.size() && verdict.at_bound.empty(); ++i)
      if (is_stuck(last.job.free[i], last.fit.parameters[i]))
        verdict.at_bound = last.fit.parameters[i].name;
    for (std::size_t r = 0; r < last.job.recordings.size(); ++r) {
      const double percent = percent_of_drive(missing_force(last.job, last.fit, r));
      if (percent <= std::max(kLargestForcePercent, verdict.force_percent)) continue;
      verdict.force_percent = percent;
      verdict.recording = last.job.recordings[r].name;
    }
    if (verdict.at_bound.empty() && verdict.recording.empty()) return;
    drop_all({.test = Rejection::Test::misfit});
  }
  void drop_all(const Rejection& rejection) {
    for (const AcceptedEffect& a : chain_.accepted()) trials_.fail(a.candidate, rejection);
    chain_.restart(chain_.declared());
  }

  /// At a bound that is not the natural end of the quantity, where it has no part in the axis.
  bool is_stuck(const FreeParameter& free, const ParameterResult& found) const {
    const double natural = declared_job().entry(free.quantity).quantity.lower;
    const bool none = free.lower == natural && natural == 0.0 &&
                      found.value - free.lower < 0.5 * (free.upper - free.lower);
    return found.uncertainty.at_bound && !none;
  }

  /// By how much all accepted effects lower the validation error.
  Improvement of_all() {
    return improvement(residual_series(declared_job(), chain_.declared().fit),
                       residual_series(current().job, current().fit));
  }

  /// Whether all that it does, to first order, is to act later: a delay or a lag.
  static bool is_delay(const Candidate& candidate) {
    return !candidate.is_constant && candidate.strengths.size() == 1 &&
           quantity_list()[candidate.strengths.front()].quantity.unit == "s";
  }
  /// Which of two clocks is off matters little: without either, all that is estimated pays for it.
  /// The chosen one stays, and the other is named beside it.
  void keep_with_equal(const RivalPair& pair) {
    trials_.reject(pair.rival, Reason::explains_equally,
                   chain_.accepted()[pair.place].candidate.name);
    add_pair(pair);
  }
  void add_pair(const RivalPair& pair) {
    result_.rivals.push_back({chain_.accepted()[pair.place].candidate.name, pair.rival.name,
                              fitted_model(current().job, current().fit), pair.model});
  }

  /// An effect that has an equal is not accepted: neither silently.
  void drop_undecided() {
    std::set<std::size_t, std::greater<>> places;
    for (const RivalPair& r : rival_pairs_) {
      const Candidate& chosen = chain_.accepted()[r.place].candidate;
      trials_.leave_undecided(chosen, r.rival.name);
      trials_.leave_undecided(r.rival, chosen.name);
      add_pair(r);
      places.insert(r.place);
    }
    for (const std::size_t place : places) take_out(place, chain_.without(place));
  }

  /// The constants that may be wrong in place of one that was corrected.
  void add_alternatives(AcceptedEffect& accepted) {
    if (!accepted.candidate.is_constant) return;
    const Job& job = current().job;
    for (Alternative& a :
         alternatives(job, current().fit, accepted.candidate, catalogue(job, {}))) {
      std::erase_if(accepted.rivals,
                    [&](const Rival& r) { return same_effect(r.candidate, a.candidate); });
      accepted.rivals.insert(accepted.rivals.begin(),
                             {a.candidate, {{a.strength}, {}}, std::move(a.values)});
    }
  }

  /// Fits those of an accepted effect's rivals that `counts` in its place, from where all else is.
  template <class Counts>
  std::vector<ExtendedModel> fit_rivals(std::size_t place, Counts&& counts) {
    constexpr std::size_t kMost = 8;
    std::vector<Rival> rivals = chain_.accepted()[place].rivals;
    std::erase_if(rivals, [&](const Rival& rival) {
      return !counts(rival.candidate) ||
             std::ranges::any_of(chain_.accepted(), [&](const AcceptedEffect& other) {
               return same_effect(other.candidate, rival.candidate);
             });
    });
    std::vector<ExtendedModel> list(std::min(rivals.size(), kMost));
    if (list.empty()) return list;
    const Job others = chain_.job_with_accepted(declared_job(), place);
    parallel_for(list.size(), [&](std::size_t i) {
      const Rival& rival = rivals[i];
      list[i] = fit_extended_model(others, rival.candidate,
                                   rival.others.empty() ? initial_values(others) : rival.others,
                                   rival.values.strengths, rival.values.shapes, context_);
    });
    std::erase_if(list, [](const ExtendedModel& e) { return !e.fit.usable; });
    return list;
  }

  /// By how much it explains the recordings worse than the present model, with these residuals.
  double loss_with(const ExtendedModel& e, const std::vector<ResidualSeries>& now) const {
    return bic_difference(now, current().job.free.size(), e.residuals, e.job.free.size());
  }

  /// Replaces the first accepted effect that has a clearly better rival.
  bool try_swap() {
    if (chain_.accepted().empty() || swapped_) return false;
    swapped_ = true;
    const auto now = residual_series(current().job, current().fit);
    for (std::size_t a = 0; a < chain_.accepted().size(); ++a) {
      const AcceptedEffect& accepted = chain_.accepted()[a];
      if (accepted.rivals.empty()) continue;
      report_progress("any better than " + accepted.candidate.name + "?");
      for (ExtendedModel& e : fit_rivals(a, [](const Candidate&) { return true; })) {
        if (!is_clearly_worse(-loss_with(e, now))) continue;
        const SelectionStep& reduced = chain_.without(a);
        judge(e, residual_series(reduced.job, reduced.fit), tried_);
        if (e.rejection) continue;
        trials_.reject(accepted.candidate, Reason::replaced, e.candidate.name);
        trials_.record(e, &e, round_);
        // The exchanged effect goes last, where its parameters are.
        strike_off(a);
        chain_.accepted().push_back({e.candidate, {}});
        chain_.set_last({e.candidate.name, std::move(e.job), std::move(e.fit)});
        return true;
      }
    }
    return false;
  }

  /// Whether a rival explains the data as well as an accepted effect, now that all else is known.
  void record_rivals() {
    std::vector<AcceptedEffect>& accepted = chain_.accepted();
    if (!accepted.empty()) report_progress("any equals?");
    for (AcceptedEffect& effect : accepted) add_alternatives(effect);
    std::vector<std::vector<ExtendedModel>> rivals(accepted.size());
    parallel_for(accepted.size(), [&](std::size_t a) {
      const Candidate& chosen = accepted[a].candidate;
      rivals[a] = fit_rivals(a, [&](const Candidate& rival) {
        // A clock that is off has precedence: no part of the machine is its equal.
        const bool is_behind = chosen.is_timing && !rival.is_timing;
        return !is_behind && rival.parameters() <= chosen.parameters();
      });
    });
    const auto now = residual_series(current().job, current().fit);
    for (std::size_t a = 0; a < accepted.size(); ++a) {
      for (const ExtendedModel& e : rivals[a]) {
        if (is_clearly_worse(loss_with(e, now))) continue;
        if (trials_.find(e.candidate) == nullptr) trials_.record(e, &e, round_);
        RivalPair pair{a, e.candidate, fitted_model(e.job, e.fit)};
        if (is_delay(accepted[a].candidate) && is_delay(e.candidate))
          keep_with_equal(pair);
        else
          rival_pairs_.push_back(std::move(pair));
      }
    }
  }

  void finish();
  void propose_closed_forms();
  std::vector<std::string> small_effects() const;
  void decide();

  const SelectionOptions options_;
  const FitResult& first_;
  const RunContext& context_;
  EffectSelection result_;
  ModelChain chain_;
  Trials trials_;
  std::optional<SearchState> last_valid_;  ///< the latest state that can be a result
  bool provisional_ = false;               ///< what is accepted has yet to prove better than that
  std::vector<RivalPair> rival_pairs_;
  std::vector<Candidate> degenerate_;  ///< not to be tried again
  std::size_t tried_ = 1;
  RoundMemory of_names_, of_curves_;
  int round_ = 0;
  bool swapped_ = false;
};

void EffectSelector::finish() {
  result_.verdict.small = small_effects();
  result_.explained = current().fit.usable && explained() && result_.verdict.small.empty();
  result_.result = current();
  // The refits on the way were content with less, and blocks that were held out count too.
  SelectionStep& last = result_.result;
  for (Recording& r : last.job.recordings) r.held_out.clear();
  if (chain_.accepted().empty()) {
    last.fit = first_;
  } else if (!result_.interrupted) {
    report_progress("final fit");
    try {
      FitResult exact = final_fit(last.job, values_of(last.fit), context_);
      if (exact.usable) last.fit = std::move(exact);
    } catch (const Interrupted&) {
      result_.interrupted = true;
    }
  }
  decide();
  try {
    propose_closed_forms();
    result_.models = chain_.models();
  } catch (const Interrupted&) {
    result_.interrupted = true;
    result_.models = {chain_.declared(), current()};
  }
  result_.effects = trials_.list();
}

/// For accepted curves, where they pass the test of the curve.
void EffectSelector::propose_closed_forms() {
  for (std::size_t a = 0; a < chain_.accepted().size(); ++a) {
    const Candidate& curve = chain_.accepted()[a].candidate;
    EffectTrial* trial = trials_.find(curve);
    if (trial == nullptr || !curve.is_curve) continue;
    auto form = closed_form(result_.result.job, result_.result.fit, curve);
    if (form && is_confirmed(*form, curve, current(), chain_.without(a), context_))
      trial->closed_form = std::move(form);
  }
}

/// Effects that were rejected for their size alone, in the last round.
std::vector<std::string> EffectSelector::small_effects() const {
  std::vector<std::string> names;
  for (const EffectTrial& t : trials_.list())
    if (t.round == round_ && t.rejection && t.rejection->test == Rejection::Test::validation_size)
      names.push_back(t.candidate.name);
  return names;
}

void EffectSelector::decide() {
  using enum SelectionVerdict::Kind;
  SelectionVerdict& verdict = result_.verdict;
  if (!chain_.declared().fit.usable) return;
  Model<double> last_model = fitted_model(result_.result.job, result_.result.fit);
  for (const EffectTrial& t : trials_.list())
    if (t.decision == Decision::undecided) verdict.undecided.push_back(t.candidate.name);
  for (const AcceptedEffect& a : chain_.accepted()) {
    verdict.accepted.push_back(a.candidate.name);
    if (a.candidate.is_constant)
      verdict.corrections.push_back({a.candidate.name, a.candidate.neutral.front(),
                                     *members(last_model)[a.candidate.strengths.front()]});
  }
  if (!verdict.accepted.empty()) {
    verdict.kind = effects_accepted;
    verdict.validate_percent = of_all().validate_percent;
  } else if (result_.explained && verdict.undecided.empty()) {
    verdict.kind = nothing_missing;
  } else if (!verdict.small.empty() && verdict.undecided.empty() && explained()) {
    verdict.kind = hardly_anything;
  } else if (result_.interrupted) {
    verdict.kind = stopped;
  } else {
    const bool is_misfit = !verdict.at_bound.empty() || !verdict.recording.empty();
    verdict.kind = is_misfit ? misfit : verdict.undecided.empty() ? none_passes : undecided;
  }
}

/// What was found while the simulation tracked, with the fits in windows that the job asks for.
EffectSelection in_windows(EffectSelection selection, const SelectionStep& declared,
                           const RunContext& context) {
  std::vector<SelectionStep>& models = selection.models;
  SelectionStep& last = selection.result;
  const auto report_progress = [&](const std::string& phase) {
    if (context.progress) context.progress({.phase = phase});
  };
  last.job.options = declared.job.options;
  report_progress("final fit");
  last.fit = models.size() > 1 ? final_fit(last.job, values_of(last.fit), context) : declared.fit;
  for (SelectionStep& model : models) {
    model.job.options = declared.job.options;
    // Where blocks are held out, they are left out of these fits alone.
    const bool is_known = !selection.held_out_blocks;
    if (is_known && &model == &models.front()) {
      model.fit = declared.fit;
    } else if (is_known && &model == &models.back()) {
      model.fit = last.fit;
    } else {
      report_progress(model.added.empty() ? "fitting" : "fitting with " + model.added);
      model.fit = refit_from(model.job, values_of(model.fit), context);
    }
  }
  SelectionVerdict& verdict = selection.verdict;
  if (models.size() > 1)
    verdict.validate_percent = improvement(residual_series(models.front().job, models.front().fit),
                                           residual_series(models.back().job, models.back().fit))
                                   .validate_percent;
  using enum SelectionVerdict::Kind;
  selection.explained = last.fit.usable && explains(last) && verdict.small.empty();
  if (verdict.kind == nothing_missing && !selection.explained) verdict.kind = none_passes;
  if (verdict.kind == none_passes && selection.explained) verdict.kind = nothing_missing;
  return selection;
}

}  // namespace

EffectSelection select_effects(const Job& job, const FitResult& first,
                               const SelectionOptions& options, const RunContext& context) {
  const ThreadPool pool(job.options.threads);
  if (window_states(job) == 0 || !first.usable)
    return EffectSelector(job, first, options, context).run();
  // The states with which windows begin take part of what is missing upon themselves, and every
  // fit with them takes minutes.
  const SelectionStep declared{"", job, first};
  const SelectionStep start = tracking(declared, context);
  EffectSelection selection = EffectSelector(start.job, start.fit, options, context).run();
  try {
    if (!selection.interrupted) selection = in_windows(selection, declared, context);
  } catch (const Interrupted&) {
    selection.interrupted = true;
  }
  return selection;
}

}  // namespace axisfit
