#include "fit/search/round.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <mutex>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "fit/criterion/gains.h"
#include "fit/search/shortlist.h"
#include "sim/effects/effects.h"

namespace axisfit {
namespace {

bool is_of_validation(const Rejection& rejection) {
  return rejection.test == Rejection::Test::validation || rejection.test == Rejection::Test::power;
}

bool all_are_rejected(const std::vector<ExtendedModel>& models) {
  return std::ranges::all_of(models,
                             [](const ExtendedModel& e) { return e.rejection.has_value(); });
}

class RoundTrial {
 public:
  RoundTrial(const SelectionStep& model, const RoundOptions& options, RoundMemory& memory,
             const RunContext& context)
      : model_(model),
        options_(options),
        memory_(memory),
        context_(context),
        before_(residual_series(model.job, model.fit)) {
    std::vector<double> values = model.values();
    if (values != memory.of) memory = {.of = std::move(values)};
  }

  RoundResult run() && {
    refit_in_turns(choice());
    keep_the_best_setting();
    // Where nothing but noise is left, what lowers no error elsewhere is chance.
    if (!options_.explained && !options_.held_out_blocks && all_are_rejected(result_.models))
      try_elsewhere();
    choose();
    return std::move(result_);
  }

 private:
  void report_progress(const std::string& phase, int done = 0, int of = 0) const {
    context_.report({phase, done, of, model_.fit.reduced_chi_square});
  }

  /// A simulation that is far from the data must track them to be scored. Of one that is close, the
  /// free run is scored, too: an instrument that errs misleads whatever tracks it.
  std::vector<double> gains_to_score() const {
    constexpr double kClose = 25.0;
    const bool is_free = !tracks(model_.job.options.criterion);
    if (is_free && options_.explained) return {0.0};
    std::vector<double> gains = score_gains(model_.job);
    if (const auto close = close_gain(model_.job, values_of(model_.fit), context_))
      gains.insert(gains.begin(), *close);
    if (is_free && model_.fit.reduced_chi_square < kClose) gains.push_back(0.0);
    return gains;
  }

  const ShortlistEntry& entry(std::size_t place) const { return memory_.list->entries[place]; }

  /// The places in the shortlist of what is to be refitted.
  std::vector<std::size_t> choice() {
    if (!memory_.list) {
      report_progress("scoring effects");
      memory_.list = shortlist(model_.job, values_of(model_.fit), gains_to_score(), options_.curves,
                               options_.shortlist, context_);
      memory_.refits.resize(memory_.list->entries.size());
    }
    result_.tried = memory_.list->tried;
    std::vector<std::size_t> places(memory_.list->entries.size());
    std::iota(places.begin(), places.end(), 0);
    std::erase_if(places, [&](std::size_t place) {
      const auto is_this = [&other = entry(place).candidate](const Candidate& c) {
        return same_effect(c, other);
      };
      return is_hopeless(entry(place)) || std::ranges::any_of(options_.excluded, is_this);
    });
    return places;
  }

  /// Whether the acceptance test would find it no better than chance. What a score promises holds
  /// to first order: the refit may find more, above all of what gains much.
  bool is_hopeless(const ShortlistEntry& entry) const {
    constexpr double kPart = 0.4, kMuch = 10.0;
    const double least = least_gain(entry.candidate, samples_of(before_), result_.tried);
    if (options_.explained) return entry.gain < least;
    return entry.promise < kPart * least && entry.gain < kMuch * least;
  }

  /// What promises little beside the best is refitted only where that does not pass, and what a
  /// simpler effect does as well where none of these does.
  void refit_in_turns(std::vector<std::size_t> places) {
    constexpr double kRival = 0.6;
    double promised = 0.0;
    for (const std::size_t place : places)
      if (!entry(place).is_second) promised = std::max(promised, entry(place).gain);
    const auto turn = [&](std::size_t place) {
      return entry(place).is_second ? 2 : entry(place).gain >= kRival * promised ? 0 : 1;
    };
    std::ranges::stable_sort(places, {}, turn);
    auto next = places.begin();
    while (next != places.end() && all_are_rejected(result_.models)) {
      const auto end = std::ranges::upper_bound(next, places.end(), turn(*next), {}, turn);
      refit_all({next, end});
      next = end;
    }
    for (; next != places.end(); ++next)
      if (entry(*next).is_second) result_.seconds.push_back(entry(*next));
  }

  /// Refits with each of these and judges it.
  void refit_all(std::span<const std::size_t> places) {
    std::vector<ExtendedModel>& models = result_.models;
    const std::size_t first = models.size();
    models.resize(first + places.size());
    // What takes longest first, so that nobody waits for it at the end.
    std::vector<std::size_t> order(places.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) {
      return entry(places[i]).candidate.parameters();
    });
    int done = 0;
    std::mutex mutex;
    parallel_for(order.size(), [&](std::size_t k) {
      const std::size_t place = places[order[k]];
      const auto report = [&](int step) {
        const std::lock_guard lock(mutex);
        done += step;
        report_progress("trying " + entry(place).candidate.name, done,
                        static_cast<int>(places.size()));
      };
      report(0);
      ExtendedModel& e = models[first + order[k]];
      e = refitted(place);
      judge(e, before_, result_.tried, options_.chance);
      if (is_cut_short(e)) {
        resume(e, context_);
        memory_.refits[place] = e;
        judge(e, before_, result_.tried, options_.chance);
      }
      report(1);
    });
  }

  /// Whether a refit promises to pass, but for want of iterations.
  bool is_cut_short(const ExtendedModel& e) const {
    return e.fit.verdict.kind == FitVerdict::Kind::no_minimum && e.gain.comparable &&
           e.gain.p_value < options_.chance &&
           e.gain.fit_gain > least_gain(e.candidate, e.gain.samples, result_.tried);
  }

  /// With an entry of the shortlist.
  const ExtendedModel& refitted(std::size_t place) {
    std::optional<ExtendedModel>& known = memory_.refits[place];
    if (!known) {
      const ShortlistEntry& p = entry(place);
      ExtendedModel e = fit_extended_model(model_.job, p.candidate, p.score.values,
                                           p.score.strengths, p.score.shapes, context_);
      e.score = p.score.gain;
      known = std::move(e);
    }
    return *known;
  }

  /// Of several settings of one effect.
  void keep_the_best_setting() {
    const auto is_preferred = [](const ExtendedModel& a, const ExtendedModel& b) {
      if (a.rejection.has_value() != b.rejection.has_value()) return !a.rejection;
      return bic_advantage(a, b) > 0.0;
    };
    std::vector<ExtendedModel> kept;
    for (ExtendedModel& e : result_.models) {
      const auto other = std::ranges::find_if(
          kept, [&](const ExtendedModel& c) { return same_effect(c.candidate, e.candidate); });
      if (other == kept.end())
        kept.push_back(std::move(e));
      else if (is_preferred(e, *other))
        *other = std::move(e);
    }
    result_.models = std::move(kept);
  }

  /// Asks other data of what explains the most, and so on down to what explains clearly less than
  /// one that they confirm.
  void try_elsewhere() {
    std::vector<ExtendedModel*> order;
    for (ExtendedModel& e : result_.models)
      if (e.fit.usable && is_of_validation(*e.rejection)) order.push_back(&e);
    std::ranges::stable_sort(order, std::greater{},
                             [](const ExtendedModel* e) { return e->gain.fit_gain; });
    constexpr std::size_t kAtOnce = 2;
    const ExtendedModel* best = nullptr;
    for (std::size_t first = 0; first < order.size(); first += kAtOnce) {
      std::span<ExtendedModel*> next(order);
      next = next.subspan(first, std::min(kAtOnce, order.size() - first));
      if (best != nullptr && is_clearly_worse(bic_advantage(*best, *next.front()))) return;
      report_progress("does " + next.front()->candidate.name + " replicate?");
      parallel_for(next.size(), [&](std::size_t i) { try_to_replicate(*next[i]); });
      std::vector<ExtendedModel*> asked;
      std::ranges::copy_if(next, std::back_inserter(asked), wants_stretches);
      try_on_stretches(asked);
      for (const ExtendedModel* e : next)
        if (best == nullptr && !e->rejection) best = e;
    }
  }

  Determination determined(const ExtendedModel& e) const {
    return determination(e.job, e.fit, e.candidate, e.residuals);
  }

  /// What lowers the error of one recording and not that of another may yet be in both, where
  /// something else differs between them.
  void try_to_replicate(ExtendedModel& e) {
    if (e.candidate.is_curve) return;  // proves nothing, see replication()
    const std::optional<FitResult> elsewhere = fitted_elsewhere(e);
    if (!elsewhere) return;
    Replication found = replication(e.job, e.fit, *elsewhere, e.candidate);
    if (!found.is_alike) return;
    e.rejection = rejection_of(e.candidate, e.gain, determined(e), result_.tried, kChance, true);
    if (!e.rejection) e.replication = std::move(found);
  }

  std::optional<FitResult> fitted_elsewhere(const ExtendedModel& e) {
    const std::vector<double> values = values_of(e.fit);
    const auto known = [&] {
      const std::lock_guard lock(elsewhere_);
      const auto found = memory_.elsewhere.find(values);
      return found == memory_.elsewhere.end() ? std::nullopt : std::optional(found->second);
    };
    if (auto found = known()) return *std::move(found);
    std::optional<FitResult> fit = fit_elsewhere(e.job, e.fit, context_);
    const std::lock_guard lock(elsewhere_);
    return memory_.elsewhere.emplace(values, std::move(fit)).first->second;
  }

  /// What the recordings to validate could not have shown is judged by stretches of the fitted
  /// ones, held out from both fits.
  void try_on_stretches(const std::vector<ExtendedModel*>& asked) {
    if (asked.empty()) return;
    report_progress("do held-out stretches show " + asked.front()->candidate.name + "?");
    const auto held_out = [&](SelectionStep model) {
      model = with_held_out_blocks(std::move(model), context_);
      auto series = residual_series(model.job, model.fit);
      std::erase_if(series, [&](const ResidualSeries& s) {
        return model.job.recordings[s.recording].role != Role::fit;
      });
      return series;
    };
    std::vector<std::vector<ResidualSeries>> with(asked.size());
    parallel_for(asked.size() + 1, [&](std::size_t i) {
      if (i > 0)
        with[i - 1] = held_out({"", asked[i - 1]->job, asked[i - 1]->fit});
      else if (!memory_.on_stretches)
        memory_.on_stretches = held_out(model_);
    });
    for (std::size_t i = 0; i < asked.size(); ++i) {
      ExtendedModel& e = *asked[i];
      Improvement gain = improvement(*memory_.on_stretches, with[i]);
      gain.fit_gain = e.gain.fit_gain;
      gain.samples = e.gain.samples;
      if (rejection_of(e.candidate, gain, determined(e), result_.tried)) continue;
      e.rejection.reset();
      e.gain = gain;
      e.on_stretches = true;
    }
  }

  /// Whether the recordings to validate could not have shown it and stretches could: a disturbance
  /// goes on from one stretch to the next, and only another recording tells it from a law.
  static bool wants_stretches(const ExtendedModel* e) {
    static const std::size_t kOverTime = *effect_named(ForceOverTime<double>::name);
    return e->rejection && e->rejection->test == Rejection::Test::power &&
           quantity_list()[e->candidate.strengths.front()].effect != kOverTime;
  }

  void choose() {
    const ExtendedModel* best = nullptr;
    for (const ExtendedModel& e : result_.models)
      if (!e.rejection && (best == nullptr || bic_advantage(e, *best) > 0.0)) best = &e;
    if (best == nullptr) return;
    const auto is_equal = [&](const ExtendedModel& e) {
      return !e.rejection && !is_clearly_worse(bic_advantage(*best, e));
    };
    // No simpler effect does as well.
    for (const ExtendedModel& e : result_.models)
      if (e.candidate.parameters() < best->candidate.parameters() && is_equal(e)) best = &e;
    // Nor does a clock that is a little off: that is no part of the machine.
    for (const ExtendedModel& e : result_.models)
      if (!best->candidate.is_timing && e.candidate.is_timing && is_equal(e)) best = &e;
    result_.best = static_cast<std::size_t>(best - result_.models.data());
  }

  const SelectionStep& model_;
  const RoundOptions& options_;
  RoundMemory& memory_;
  std::mutex elsewhere_;  // of the memory
  const RunContext& context_;
  const std::vector<ResidualSeries> before_;
  RoundResult result_;
};

}  // namespace

RoundResult try_round(const SelectionStep& model, const RoundOptions& options, RoundMemory& memory,
                      const RunContext& context) {
  return RoundTrial(model, options, memory, context).run();
}

void judge(ExtendedModel& e, const std::vector<ResidualSeries>& before, std::size_t tried,
           double chance) {
  e.gain = improvement(before, e.residuals);
  e.rejection = e.fit.usable ? rejection_of(e.candidate, e.gain,
                                            determination(e.job, e.fit, e.candidate, e.residuals),
                                            tried, chance)
                             : Rejection{.test = Rejection::Test::fit};
}

SelectionStep with_held_out_blocks(SelectionStep model, const RunContext& context) {
  constexpr std::size_t kBlocks = 10;
  for (Recording& r : model.job.recordings) {
    r.held_out.assign(r.times.size(), false);
    for (std::size_t i = 0; i < r.times.size(); ++i)
      r.held_out[i] = i * kBlocks / r.times.size() % 2 == 1;
  }
  model.fit = refit_from(model.job, values_of(model.fit), context);
  return model;
}

}  // namespace axisfit
