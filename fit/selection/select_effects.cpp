#include "fit/selection/select_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>
#include <span>

#include "base/parallel.h"
#include "fit/residuals/missing_force.h"
#include "fit/selection/alternatives.h"
#include "fit/selection/extended_model.h"
#include "fit/selection/grade.h"
#include "fit/selection/shortlist.h"

namespace axisfit {
namespace {

class EffectSelector {
 public:
  EffectSelector(const Job& job, const FitResult& first, const SelectionOptions& options,
                 const RunContext& context)
      : options_(options), first_(first), context_(context) {
    result_.models.push_back({"", job, first});
    if (std::ranges::none_of(job.recordings,
                             [](const Recording& r) { return r.role == Role::validate; })) {
      result_.held_out_blocks = true;
      hold_out_blocks(result_.models.back());
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
        record_replications();
      } catch (const Interrupted&) {
        result_.interrupted = true;
        restore(std::move(last_valid_));
      }
      drop_all_where_half_remains();
      drop_all_of_a_misfit();
    }
    finish();
    return std::move(result_);
  }

 private:
  struct Rival {
    Candidate candidate;
    CandidateValues values;
    /// Of the other free parameters, where its refit starts; empty: from where all else is.
    std::vector<double> others{};
  };
  struct Accepted {
    Candidate candidate;
    std::vector<Rival> rivals;       ///< that explained as much when it was chosen
    bool is_seen_elsewhere = false;  ///< it replicates, or held-out stretches show it
  };

  /// An accepted effect (its place) and another that explains the data as well.
  struct RivalPair {
    std::size_t place = 0;
    Candidate rival;
    Model<double> model;  ///< fitted with the rival in its place
  };

  /// Where a search stands.
  struct SearchState {
    std::vector<SelectionStep> models;
    std::vector<EffectTrial> effects;
    std::vector<Accepted> accepted;
  };

  SelectionStep& current() { return result_.models.back(); }
  const SelectionStep& current() const { return result_.models.back(); }

  /// Adds named effects as long as one passes. If they do not suffice, tries again while the
  /// simulation tracks the data, and then with a curve first: named effects may have imitated part
  /// of something that is in no catalogue.
  void search() {
    search_named();
    if (explained()) return;
    SearchState strict = snapshot();
    provisional_ = true;
    search_together();
    provisional_ = false;
    if (!is_better(current(), strict.models.back())) restore(std::move(strict));
    last_valid_ = snapshot();
    if (explained()) return;
    const SearchState named = snapshot();
    while (has_room() && round(true)) {
    }
    const SearchState appended = snapshot();
    const bool appends = accepted_.size() > named.accepted.size();
    // A simulation that tracks the data shows a curve also beside effects that imitate a part of
    // it.
    const bool tracks = declared_job().options.observer == ObserverMode::fixed;
    if (named.accepted.empty() || (tracks && !appends)) return;
    provisional_ = true;
    restart();
    if (!round(true)) return restore(appended);
    search_named();
    eliminate_backward();
    const double loss = loss_of(appended.models.back(), current());
    if (loss > 0.0 && (appends || is_clearly_worse(loss))) restore(appended);
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
  /// leniently until all are known, and strictly by backward elimination.
  void search_together() {
    constexpr double kProvisionalChance = 0.05;
    const SelectionStep declared = result_.models.front();
    const bool is_continued = declared.job.options.observer == ObserverMode::continuation;
    if (is_continued) {
      restart();
      SelectionStep& tracking = result_.models.front();
      tracking.job.options.observer = ObserverMode::fixed;
      tracking.job.options.observer_gain = score_gains(declared.job).front();
      tracking.fit = refit_from(tracking.job, values_of(declared.fit), context_);
    }
    while (current().fit.usable && has_room() && !explained() && round(false, kProvisionalChance)) {
    }
    if (is_continued) {
      SelectionStep all = accepted_.empty() ? declared : with_accepted(declared.job);
      result_.models = {declared};
      if (accepted_.empty() || !all.fit.usable) return restart();
      rebuild(std::move(all));
    }
    search_named();
    eliminate_backward();
  }
  bool has_room() const {
    return accepted_.size() < static_cast<std::size_t>(options_.max_effects);
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
    for (std::size_t a = 0; a < accepted_.size(); ++a) {
      const Candidate candidate = accepted_[a].candidate;
      const std::string shape = shape_at_bound(current().job, current().fit, candidate);
      if (shape.empty()) continue;
      SelectionStep reduced = without(a);
      if (!reduced.fit.usable) continue;
      fail(candidate, {.test = Rejection::Test::bound, .parameter = shape});
      degenerate_.push_back(candidate);
      erase_accepted(a);
      rebuild(std::move(reduced));
      return true;
    }
    return false;
  }

  SearchState snapshot() const { return {result_.models, result_.effects, accepted_}; }
  void restore(SearchState snapshot) {
    result_.models = std::move(snapshot.models);
    result_.effects = std::move(snapshot.effects);
    accepted_ = std::move(snapshot.accepted);
  }
  void restart() {
    result_.models.resize(1);
    result_.effects.clear();
    accepted_.clear();
    degenerate_.clear();
  }

  void report_progress(const std::string& phase, int done = 0, int of = 0) {
    if (context_.progress) context_.progress({phase, done, of, current().fit.reduced_chi_square});
  }

  /// Every second of ten stretches of each recording is left to be judged only.
  void hold_out_blocks(SelectionStep& model) {
    constexpr std::size_t kBlocks = 10;
    for (Recording& r : model.job.recordings) {
      r.held_out.assign(r.times.size(), false);
      for (std::size_t i = 0; i < r.times.size(); ++i)
        r.held_out[i] = i * kBlocks / r.times.size() % 2 == 1;
    }
    model.fit = refit_from(model.job, values_of(model.fit), context_);
  }

  bool explained() {
    auto series = residual_series(current().job, current().fit);
    if (std::ranges::all_of(series, is_explained)) return !series.empty();
    allow_for_parameters(current().job, current().fit, series);
    return !series.empty() && std::ranges::all_of(series, is_explained);
  }

  void judge(ExtendedModel& e, const std::vector<ResidualSeries>& before,
             double chance = kChance) const {
    e.gain = improvement(before, e.residuals);
    e.rejection = e.fit.usable ? rejection_of(e.candidate, e.gain,
                                              determination(e.job, e.fit, e.candidate, e.residuals),
                                              tried_, chance)
                               : Rejection{.test = Rejection::Test::fit};
  }

  /// Refits a shortlist and takes the best that passes the gate. Returns whether one did. Where the
  /// size of the residual is that of the noise, an effect may yet be hidden in it: then only those
  /// are refitted whose score is beyond chance.
  bool round(bool curves, double chance = kChance) {
    const auto begin = std::chrono::steady_clock::now();
    ++round_;
    const bool passed = try_round(curves, chance);
    if (context_.progress) {
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
      context_.progress({.phase = "search",
                         .best = current().fit.reduced_chi_square,
                         .finished = fmt::format("round {}, {:.1f} s: {}", round_, time.count(),
                                                 passed ? current().added : "none")});
    }
    return passed;
  }

  bool try_round(bool curves, double chance) {
    stretches_before_.reset();
    report_progress("scoring effects");
    const bool is_complete = explained();
    Shortlist list = shortlist(current().job, values_of(current().fit), rates_to_score(is_complete),
                               curves, options_.shortlist, context_);
    std::vector<ShortlistEntry>& entries = list.entries;
    tried_ = list.tried;
    std::erase_if(entries, [&](const ShortlistEntry& entry) {
      return std::ranges::any_of(
          degenerate_, [&](const Candidate& c) { return same_effect(c, entry.candidate); });
    });
    const auto before = residual_series(current().job, current().fit);
    if (is_complete)
      std::erase_if(entries, [&](const ShortlistEntry& entry) {
        return entry.gain < least_gain(entry.candidate, samples_of(before), tried_);
      });
    // What promises little beside the best is refitted only where that does not pass, and what a
    // simpler effect does as well where none of these does.
    constexpr double kRival = 0.6;
    double promised = 0.0;
    for (const ShortlistEntry& entry : entries)
      if (!entry.is_second) promised = std::max(promised, entry.gain);
    const auto turn = [&](const ShortlistEntry& entry) {
      return entry.is_second ? 2 : entry.gain >= kRival * promised ? 0 : 1;
    };
    std::ranges::stable_sort(entries, {}, turn);
    std::vector<ExtendedModel> extended_models;
    for (auto next = entries.begin(); next != entries.end();) {
      const auto end = std::ranges::upper_bound(next, entries.end(), turn(*next), {}, turn);
      refit_all({next, end}, before, chance, extended_models);
      if (std::ranges::any_of(extended_models, [](const ExtendedModel& e) { return !e.rejection; }))
        break;
      next = end;
    }
    // Of several settings of one candidate the best counts.
    std::vector<ExtendedModel*> contenders;
    for (ExtendedModel& e : extended_models) {
      const auto other = std::ranges::find_if(contenders, [&](const ExtendedModel* c) {
        return same_effect(c->candidate, e.candidate);
      });
      if (other == contenders.end())
        contenders.push_back(&e);
      else if (is_preferred(e, **other))
        *other = &e;
    }
    // Where nothing but noise is left, what lowers no error elsewhere is chance.
    if (!is_complete && std::ranges::all_of(contenders, [](const ExtendedModel* e) {
          return e->rejection.has_value();
        }))
      for (ExtendedModel* e : contenders) {
        try_to_replicate(*e);
        try_on_stretches(*e);
      }
    ExtendedModel* best = nullptr;
    for (ExtendedModel* e : contenders)
      if (!e->rejection && (best == nullptr || bic_advantage(*e, *best) > 0.0)) best = e;
    // No simpler effect does as well.
    for (ExtendedModel* e : contenders)
      if (best != nullptr && !e->rejection &&
          e->candidate.parameters() < best->candidate.parameters() &&
          !is_clearly_worse(bic_advantage(*best, *e)))
        best = e;
    // Nor does a clock that is a little off: that is no part of the machine.
    for (ExtendedModel* e : contenders)
      if (best != nullptr && !best->candidate.is_timing && e->candidate.is_timing &&
          !e->rejection && !is_clearly_worse(bic_advantage(*best, *e)))
        best = e;
    for (ExtendedModel* e : contenders) record_trial(*e, best);
    if (best == nullptr) return false;

    Accepted accepted{best->candidate, {}, best->replication || best->on_stretches};
    for (const ExtendedModel* e : contenders) {
      if (e == best || !e->fit.usable || !e->gain.comparable) continue;
      // Rivals are seen again when all else is explained.
      if (is_clearly_worse(bic_advantage(*best, *e))) continue;
      accepted.rivals.push_back({e->candidate, candidate_values(e->job, e->fit, e->candidate)});
    }
    accepted_.push_back(std::move(accepted));
    result_.models.push_back({best->candidate.name, std::move(best->job), std::move(best->fit)});
    if (!provisional_) last_valid_ = snapshot();
    return true;
  }

  /// Refits with each of these and judges it.
  void refit_all(std::span<const ShortlistEntry> entries, const std::vector<ResidualSeries>& before,
                 double chance, std::vector<ExtendedModel>& extended_models) {
    const std::size_t first = extended_models.size();
    extended_models.resize(first + entries.size());
    // What takes longest first, so that nobody waits for it at the end.
    std::vector<std::size_t> order(entries.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater{},
                             [&](std::size_t i) { return entries[i].candidate.parameters(); });
    int done = 0;
    std::mutex mutex;
    parallel_for(order.size(), [&](std::size_t k) {
      const ShortlistEntry& p = entries[order[k]];
      const auto report = [&](int step) {
        const std::lock_guard lock(mutex);
        done += step;
        report_progress("trying " + p.candidate.name, done, static_cast<int>(entries.size()));
      };
      report(0);
      ExtendedModel& e = extended_models[first + order[k]];
      e = fit_extended_model(current().job, p.candidate, p.score.values, p.score.strengths,
                             p.score.shapes, context_);
      e.score = p.score.gain;
      judge(e, before, chance);
      report(1);
    });
  }

  static bool is_of_validation(const Rejection& rejection) {
    return rejection.test == Rejection::Test::validation ||
           rejection.test == Rejection::Test::power;
  }

  /// What lowers the error of one recording and not that of another may yet be in both, where
  /// something else differs between them.
  void try_to_replicate(ExtendedModel& e) {
    if (!e.fit.usable || !e.rejection || !is_of_validation(*e.rejection) || result_.held_out_blocks)
      return;
    report_progress("does " + e.candidate.name + " replicate?");
    const auto elsewhere = fit_elsewhere(e.job, e.fit, context_);
    if (!elsewhere) return;
    Replication found = replication(e.job, e.fit, *elsewhere, e.candidate);
    if (!found.is_alike) return;
    e.rejection =
        rejection_of(e.candidate, e.gain, determination(e.job, e.fit, e.candidate, e.residuals),
                     tried_, kChance, true);
    if (!e.rejection) e.replication = std::move(found);
  }

  /// What the recordings to validate could not have shown is judged by stretches of the fitted
  /// ones, held out from both fits.
  void try_on_stretches(ExtendedModel& e) {
    if (!e.fit.usable || !e.rejection || e.rejection->test != Rejection::Test::power ||
        result_.held_out_blocks)
      return;
    report_progress("do held-out stretches show " + e.candidate.name + "?");
    const auto held_out = [&](SelectionStep model) {
      hold_out_blocks(model);
      auto series = residual_series(model.job, model.fit);
      std::erase_if(series, [&](const ResidualSeries& s) {
        return model.job.recordings[s.recording].role != Role::fit;
      });
      return series;
    };
    if (!stretches_before_) stretches_before_ = held_out(current());
    Improvement gain = improvement(*stretches_before_, held_out({"", e.job, e.fit}));
    gain.fit_gain = e.gain.fit_gain;
    gain.samples = e.gain.samples;
    if (rejection_of(e.candidate, gain, determination(e.job, e.fit, e.candidate, e.residuals),
                     tried_))
      return;
    e.rejection.reset();
    e.gain = gain;
    e.on_stretches = true;
  }

  /// A simulation that is far from the data must track them to be scored. Of one that is not, the
  /// free-running residual is white, and its score is exact.
  std::vector<double> rates_to_score(bool is_complete) const {
    const Job& job = result_.models.back().job;
    if (is_complete && job.options.observer != ObserverMode::fixed) return {0.0};
    return score_gains(job);
  }

  static bool is_preferred(const ExtendedModel& a, const ExtendedModel& b) {
    if (a.rejection.has_value() != b.rejection.has_value()) return !a.rejection;
    return bic_advantage(a, b) > 0.0;
  }

  void record_trial(const ExtendedModel& e, const ExtendedModel* best) {
    EffectTrial trial;
    trial.candidate = e.candidate;
    trial.round = round_;
    trial.score = e.score;
    trial.improvement = e.gain;
    const std::size_t first = e.job.free.size() - e.candidate.parameters();
    trial.parameters.assign(e.fit.parameters.begin() + static_cast<std::ptrdiff_t>(first),
                            e.fit.parameters.end());
    if (&e == best) {
      trial.decision = Decision::accepted;
      trial.reason = e.replication    ? Reason::replicates
                     : e.on_stretches ? Reason::shown_by_stretches
                                      : Reason::explains_best;
      trial.replication = e.replication;
    } else if (e.rejection) {
      trial.rejection = e.rejection;
    } else {
      trial.reason = Reason::explains_less;
      trial.other = best->candidate.name;
    }
    const auto known = std::ranges::find_if(result_.effects, [&](const EffectTrial& t) {
      return same_effect(t.candidate, e.candidate);
    });
    if (known == result_.effects.end())
      result_.effects.push_back(std::move(trial));
    else
      *known = std::move(trial);
  }

  EffectTrial* trial_of(const Candidate& candidate) {
    for (EffectTrial& t : result_.effects)
      if (same_effect(t.candidate, candidate)) return &t;
    return nullptr;
  }

  /// Writes down that an effect is out; returns its trial, if it had one.
  EffectTrial* reject(const Candidate& candidate, Reason reason) {
    EffectTrial* trial = trial_of(candidate);
    if (trial != nullptr) {
      trial->decision = Decision::rejected;
      trial->reason = reason;
    }
    return trial;
  }
  void fail(const Candidate& candidate, Rejection rejection) {
    if (EffectTrial* trial = reject(candidate, Reason::failed_test))
      trial->rejection = std::move(rejection);
  }

  /// What was fitted beside the present model.
  struct Neighbours {
    std::vector<double> of;                             ///< values and gain of that model
    std::vector<std::optional<SelectionStep>> reduced;  ///< without each of the accepted effects
    bool has_elsewhere = false;
    std::optional<FitResult> elsewhere;  ///< to the recordings to validate
  };
  Neighbours& neighbours() {
    std::vector<double> values = values_of(current().fit);
    values.push_back(current().fit.observer_gain);
    if (values != neighbours_.of || neighbours_.reduced.size() != accepted_.size())
      neighbours_ = {std::move(values), {accepted_.size(), std::nullopt}, false, std::nullopt};
    return neighbours_;
  }

  /// Strikes an accepted effect off the list, and what is part of it.
  void erase_accepted(std::size_t place) {
    const Candidate whole = accepted_[place].candidate;
    std::erase_if(accepted_, [&](const Accepted& a) {
      if (!is_part_of(a.candidate, whole)) return same_effect(a.candidate, whole);
      reject(a.candidate, Reason::not_needed);
      return true;
    });
  }

  /// The model without one accepted effect, and what is part of it, refitted.
  const SelectionStep& without(std::size_t index) {
    std::optional<SelectionStep>& reduced = neighbours().reduced[index];
    if (!reduced) reduced = reduce(index);
    return *reduced;
  }
  SelectionStep reduce(std::size_t index) const {
    return accepted_.size() == 1 ? result_.models.front() : with_accepted(declared_job(), index);
  }
  /// Fits without each of these, side by side.
  void reduce_by(const std::vector<std::size_t>& places) {
    auto& all = neighbours().reduced;
    parallel_for(places.size(), [&](std::size_t i) {
      if (!all[places[i]]) all[places[i]] = reduce(places[i]);
    });
  }

  /// A job with the accepted effects, but for one, that starts from where they are.
  Job job_with_accepted(const Job& declared, std::optional<std::size_t> except = {}) const {
    Job job = declared;
    std::vector<double> values;
    for (std::size_t i = 0; i < job.free.size(); ++i)
      values.push_back(current().fit.parameters[i].value);
    for (std::size_t a = 0; a < accepted_.size(); ++a) {
      const Candidate& candidate = accepted_[a].candidate;
      if (except && (a == *except || is_part_of(candidate, accepted_[*except].candidate))) continue;
      const CandidateValues own = candidate_values(current().job, current().fit, candidate);
      job = with_candidate(job, candidate, values, own.strengths, own.shapes);
      values = initial_values(job);
    }
    for (std::size_t i = 0; i < values.size(); ++i)
      job.free[i].initial = std::clamp(values[i], job.free[i].lower, job.free[i].upper);
    return job;
  }
  static std::vector<double> initial_values(const Job& job) {
    std::vector<double> values;
    for (const FreeParameter& p : job.free) values.push_back(p.initial);
    return values;
  }
  SelectionStep with_accepted(const Job& declared, std::optional<std::size_t> except = {}) const {
    Job job = job_with_accepted(declared, except);
    FitResult fit = refit(job, context_);
    return {"", std::move(job), std::move(fit)};
  }

  const Job& declared_job() const { return result_.models.front().job; }

  /// Takes away what is not needed any more, or never was but to a simulation that tracks. Where
  /// the fit stays far from the noise, what the recordings to validate tell alike beside all other
  /// effects is needed.
  void eliminate_backward() {
    for (std::size_t a = 0; a < accepted_.size();) {
      const Candidate& candidate = accepted_[a].candidate;
      const bool is_far = !explained();
      const auto is_plain = [&](const Candidate& c) { return is_far && is_alike_elsewhere(c); };
      if (is_plain(candidate)) {
        ++a;
        continue;
      }
      report_progress("is " + candidate.name + " necessary?");
      std::vector<std::size_t> doubted;
      for (std::size_t b = a; b < accepted_.size(); ++b)
        if (!is_plain(accepted_[b].candidate)) doubted.push_back(b);
      reduce_by(doubted);
      SelectionStep reduced = without(a);
      const Improvement gain = improvement(residual_series(reduced.job, reduced.fit),
                                           residual_series(current().job, current().fit));
      if (!reduced.fit.usable ||
          is_needed(gain, candidate.parameters(), accepted_[a].is_seen_elsewhere)) {
        ++a;
        continue;
      }
      reject(candidate, Reason::not_needed);
      erase_accepted(a);
      rebuild(std::move(reduced));
      a = 0;
    }
  }

  /// Where the fit stays far from the noise, a flexible effect lowers every error a little,
  /// whatever is missing: named is only what accounts for a good part of it, or what other
  /// recordings show alike.
  void drop_imitators() {
    constexpr double kLeastPercent = 25.0;
    while (!accepted_.empty() && !explained()) {
      const auto now = residual_series(current().job, current().fit);
      SelectionStep least;
      std::size_t place = 0;
      double percent = kLeastPercent;
      for (std::size_t a = 0; a < accepted_.size(); ++a) {
        const Candidate& candidate = accepted_[a].candidate;
        if (candidate.is_curve || is_alike_elsewhere(candidate)) continue;
        report_progress("what does " + candidate.name + " explain?");
        SelectionStep reduced = without(a);
        const Improvement gain = improvement(residual_series(reduced.job, reduced.fit), now);
        if (!reduced.fit.usable || gain.missing_percent >= percent) continue;
        percent = gain.missing_percent;
        place = a;
        least = std::move(reduced);
      }
      if (!least.fit.usable) return;
      fail(accepted_[place].candidate, {.test = Rejection::Test::share, .found = percent});
      erase_accepted(place);
      rebuild(std::move(least));
    }
  }

  const std::optional<FitResult>& fit_elsewhere_now() {
    Neighbours& known = neighbours();
    if (!known.has_elsewhere && !result_.held_out_blocks) {
      report_progress("do the recordings to validate tell the same?");
      known.elsewhere = fit_elsewhere(current().job, current().fit, context_);
      known.has_elsewhere = true;
    }
    return known.elsewhere;
  }
  bool is_alike_elsewhere(const Candidate& candidate) {
    const std::optional<FitResult>& elsewhere = fit_elsewhere_now();
    return elsewhere && replication(current().job, current().fit, *elsewhere, candidate).is_alike;
  }

  /// What the recordings to validate, fitted by themselves, say of what was accepted.
  void record_replications() {
    if (accepted_.empty()) return;
    if (const auto& elsewhere = fit_elsewhere_now())
      for (const Accepted& a : accepted_)
        if (EffectTrial* trial = trial_of(a.candidate))
          trial->replication = replication(current().job, current().fit, *elsewhere, a.candidate);
  }

  /// Of a model with which most of the error remains, no part is named.
  void drop_all_where_half_remains() {
    constexpr double kLeastPercent = 50.0;
    if (accepted_.empty() || explained()) return;
    const double percent = of_all().missing_percent;
    if (percent >= kLeastPercent) return;
    for (const Accepted& a : accepted_)
      fail(a.candidate, {.test = Rejection::Test::share, .found = percent});
    accepted_.clear();
    result_.models.resize(1);
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
    for (const Accepted& a : accepted_) fail(a.candidate, {.test = Rejection::Test::misfit});
    accepted_.clear();
    result_.models.resize(1);
  }

  /// At a bound that is not the natural end of the quantity, where it has no part in the axis.
  static bool is_stuck(const FreeParameter& free, const ParameterResult& found) {
    const double natural = quantity_list()[free.quantity].quantity.lower;
    const bool none = free.lower == natural && natural == 0.0 &&
                      found.value - free.lower < 0.5 * (free.upper - free.lower);
    return found.uncertainty.at_bound && !none;
  }

  /// By how much all accepted effects lower the validation error.
  Improvement of_all() {
    return improvement(residual_series(declared_job(), result_.models.front().fit),
                       residual_series(current().job, current().fit));
  }

  /// Refits the intermediate models after an effect was removed or swapped; the last one is given.
  void rebuild(SelectionStep last) {
    std::vector<SelectionStep> models;
    models.push_back(std::move(result_.models.front()));
    for (std::size_t a = 0; a + 1 < accepted_.size(); ++a) {
      const Candidate& candidate = accepted_[a].candidate;
      const CandidateValues own = candidate_values(last.job, last.fit, candidate);
      ExtendedModel e =
          fit_extended_model(models.back().job, candidate, values_of(models.back().fit),
                             own.strengths, own.shapes, context_);
      models.push_back({candidate.name, std::move(e.job), std::move(e.fit)});
    }
    if (!accepted_.empty()) {
      last.added = accepted_.back().candidate.name;
      models.push_back(std::move(last));
    }
    result_.models = std::move(models);
  }

  /// Which of two clocks is off matters little: without either, all that is estimated pays for it.
  /// The chosen one stays, and the other is named beside it.
  void keep_with_equal(const RivalPair& pair) {
    const Candidate& chosen = accepted_[pair.place].candidate;
    if (EffectTrial* trial = reject(pair.rival, Reason::explains_equally)) {
      trial->rejection.reset();
      trial->other = chosen.name;
    }
    add_pair(pair);
  }
  void add_pair(const RivalPair& pair) {
    result_.rivals.push_back({accepted_[pair.place].candidate.name, pair.rival.name,
                              fitted_model(current().job, current().fit), pair.model});
  }

  /// An effect that has an equal is not accepted: neither silently.
  void drop_undecided() {
    std::set<std::size_t, std::greater<>> places;
    for (const RivalPair& r : rival_pairs_) {
      const Candidate& chosen = accepted_[r.place].candidate;
      const auto undecide = [&](const Candidate& candidate, const Candidate& other) {
        if (EffectTrial* trial = trial_of(candidate)) {
          trial->decision = Decision::undecided;
          trial->reason = Reason::explains_equally;
          trial->rejection.reset();
          trial->other = other.name;
        }
      };
      undecide(chosen, r.rival);
      undecide(r.rival, chosen);
      add_pair(r);
      places.insert(r.place);
    }
    for (const std::size_t place : places) {
      SelectionStep reduced = without(place);
      erase_accepted(place);
      rebuild(std::move(reduced));
    }
  }

  /// The constants that may be wrong in place of one that was corrected.
  void add_alternatives(Accepted& accepted) {
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
    std::vector<Rival> rivals = accepted_[place].rivals;
    std::erase_if(rivals, [&](const Rival& rival) {
      return !counts(rival.candidate) || std::ranges::any_of(accepted_, [&](const Accepted& other) {
        return same_effect(other.candidate, rival.candidate);
      });
    });
    std::vector<ExtendedModel> list(std::min(rivals.size(), kMost));
    if (list.empty()) return list;
    const Job others = job_with_accepted(declared_job(), place);
    parallel_for(list.size(), [&](std::size_t i) {
      const Rival& rival = rivals[i];
      list[i] = fit_extended_model(others, rival.candidate,
                                   rival.others.empty() ? initial_values(others) : rival.others,
                                   rival.values.strengths, rival.values.shapes, context_);
    });
    std::erase_if(list, [](const ExtendedModel& e) { return !e.fit.usable; });
    return list;
  }

  /// By how much it explains the recordings worse than the present model.
  double loss_with(const ExtendedModel& e) {
    return bic_difference(residual_series(current().job, current().fit), current().job.free.size(),
                          e.residuals, e.job.free.size());
  }

  /// Replaces the first accepted effect that has a clearly better rival.
  bool try_swap() {
    if (accepted_.empty() || swapped_) return false;
    swapped_ = true;
    for (std::size_t a = 0; a < accepted_.size(); ++a) {
      Accepted& accepted = accepted_[a];
      if (accepted.rivals.empty()) continue;
      report_progress("any better than " + accepted.candidate.name + "?");
      for (ExtendedModel& e : fit_rivals(a, [](const Candidate&) { return true; })) {
        if (!is_clearly_worse(-loss_with(e))) continue;
        const SelectionStep& reduced = without(a);
        judge(e, residual_series(reduced.job, reduced.fit));
        if (e.rejection) continue;
        if (EffectTrial* old = reject(accepted.candidate, Reason::replaced))
          old->other = e.candidate.name;
        record_trial(e, &e);
        // The exchanged effect goes last, where its parameters are.
        erase_accepted(a);
        accepted_.push_back({e.candidate, {}});
        rebuild({e.candidate.name, std::move(e.job), std::move(e.fit)});
        return true;
      }
    }
    return false;
  }

  /// Whether a rival explains the data as well as an accepted effect, now that all else is known.
  void record_rivals() {
    if (!accepted_.empty()) report_progress("any equals?");
    for (Accepted& accepted : accepted_) add_alternatives(accepted);
    std::vector<std::vector<ExtendedModel>> rivals(accepted_.size());
    parallel_for(accepted_.size(), [&](std::size_t a) {
      const Candidate& chosen = accepted_[a].candidate;
      rivals[a] = fit_rivals(a, [&](const Candidate& rival) {
        // A clock that is off has precedence: no part of the machine is its equal.
        const bool is_behind = chosen.is_timing && !rival.is_timing;
        return !is_behind && rival.parameters() <= chosen.parameters();
      });
    });
    for (std::size_t a = 0; a < accepted_.size(); ++a) {
      for (const ExtendedModel& e : rivals[a]) {
        if (is_clearly_worse(loss_with(e))) continue;
        if (trial_of(e.candidate) == nullptr) record_trial(e, &e);
        RivalPair pair{a, e.candidate, fitted_model(e.job, e.fit)};
        if (accepted_[a].candidate.is_timing && e.candidate.is_timing)
          keep_with_equal(pair);
        else
          rival_pairs_.push_back(std::move(pair));
      }
    }
  }

  void finish();
  std::vector<std::string> small_effects() const;
  void decide();

  const SelectionOptions options_;
  const FitResult& first_;
  const RunContext& context_;
  EffectSelection result_;
  SearchState last_valid_;    ///< the latest state that can be a result
  bool provisional_ = false;  ///< what is accepted has yet to prove better than that
  std::vector<Accepted> accepted_;
  std::vector<RivalPair> rival_pairs_;
  std::vector<Candidate> degenerate_;  ///< not to be tried again
  std::size_t tried_ = 1;
  Neighbours neighbours_;
  /// Of the current model, fitted to every second stretch, once an effect was tried so.
  std::optional<std::vector<ResidualSeries>> stretches_before_;
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
  if (accepted_.empty()) {
    last.fit = first_;
  } else if (!result_.interrupted) {
    report_progress("final fit");
    Job near = last.job;
    const auto values = values_of(last.fit);
    for (std::size_t i = 0; i < values.size(); ++i) near.free[i].initial = values[i];
    near.options.starts = 1;
    near.options.attempts = 1;
    if (near.options.observer == ObserverMode::continuation)
      near.options.observer_gain = score_gains(near).back();
    try {
      FitResult exact = estimate(near, context_.quiet());
      if (exact.usable) last.fit = std::move(exact);
    } catch (const Interrupted&) {
      result_.interrupted = true;
    }
  }
  decide();
}

/// Effects that were rejected for their size alone, in the last round.
std::vector<std::string> EffectSelector::small_effects() const {
  std::vector<std::string> names;
  for (const EffectTrial& t : result_.effects)
    if (t.round == round_ && t.rejection && t.rejection->test == Rejection::Test::validation_size)
      names.push_back(t.candidate.name);
  return names;
}

void EffectSelector::decide() {
  using enum SelectionVerdict::Kind;
  SelectionVerdict& verdict = result_.verdict;
  if (!result_.models.front().fit.usable) return;
  Model<double> last_model = fitted_model(result_.result.job, result_.result.fit);
  for (const EffectTrial& t : result_.effects)
    if (t.decision == Decision::undecided) verdict.undecided.push_back(t.candidate.name);
  for (const Accepted& a : accepted_) {
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

}  // namespace

EffectSelection select_effects(const Job& job, const FitResult& first,
                               const SelectionOptions& options, const RunContext& context) {
  const ThreadPool pool(job.options.threads);
  return EffectSelector(job, first, options, context).run();
}

}  // namespace axisfit
