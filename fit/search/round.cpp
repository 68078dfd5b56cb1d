#include "fit/search/round.h"

#include <algorithm>
#include <array>
#include <cmath>
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

namespace axisfit {
namespace {

/// The least of what an independent sample of a fitted series may count, in its mean square.
double least_unit(const std::vector<ResidualSeries>& list) {
  double unit = INFINITY;
  for (const ResidualSeries& series : list) {
    if (!series.fitted) continue;
    const std::vector<double> slow(series.values.size(), 1.0);
    unit = std::min({unit, mean_square(series.values), variance_along(slow, series.values)});
  }
  return unit;
}

bool all_are_rejected(const std::vector<Tried>& models) {
  return std::ranges::all_of(models, [](const Tried& e) { return e.rejection.has_value(); });
}

class RoundTrial {
 public:
  RoundTrial(const FittedModel& model, const RoundOptions& options, RoundMemory& memory,
             const SearchContext& context)
      : model_(model),
        options_(options),
        memory_(memory),
        context_(context),
        before_(residual_series(model.job, model.fit)),
        unit_(least_unit(before_)),
        is_exact_(options.explained || is_near_noise(before_, context.options)) {
    std::vector<double> values = model.values();
    if (values != memory.of) memory = {.of = std::move(values)};
  }

  RoundResult run() && {
    if (options_.pairs && (result_.pair = large_pair())) return std::move(result_);
    refit_in_turns(choice());
    if (all_are_rejected(result_.models) && score_the_rest()) {
      result_.models.clear();
      result_.unrefitted.clear();
      refit_in_turns(choice());
    }
    keep_the_best_setting();
    // Where nothing but noise is left, what lowers no error elsewhere is chance.
    if (!options_.explained && options_.elsewhere && all_are_rejected(result_.models)) {
      ask_elsewhere(model_, result_.models, strict(), memory_.elsewhere, context_);
      reject_what_does_harm();
    }
    choose();
    return std::move(result_);
  }

 private:
  void report_progress(const std::string& phase, int done = 0, int of = 0,
                       Work work = Work::trials) const {
    context_.run.report({.phase = phase,
                         .done = done,
                         .of = of,
                         .best = model_.fit.reduced_chi_square,
                         .work = work});
  }

  bool is_free() const { return !tracks(model_.job.options.criterion); }
  bool is_close() const { return axisfit::is_close(model_, context_.options); }

  /// Whether no simulation that tracks is scored: where next to nothing is missing the noise of the
  /// readings, which drives it, promises more.
  bool is_scored_freely() const {
    return is_free() && (is_exact_ || leaves_little(model_, context_.options));
  }

  /// A simulation that is far from the data must track them to be scored.
  double first_gain() const {
    const bool is_free_first = is_free() && (is_exact_ || is_near(model_, context_.options));
    return is_free_first ? 0.0 : score_gains(model_.job).front();
  }

  /// The gains that the list lacks, at first the free run where it is close to the data: an
  /// instrument that errs misleads whatever tracks it. What is large is tried at a high gain, too.
  std::vector<double> other_gains() const {
    if (is_scored_freely()) return {};
    const std::vector<double>& known = memory_.list->observer_gains;
    const auto is_known = [&](double gain) {
      return std::ranges::find(known, gain) != known.end();
    };
    if (is_free() && is_close() && !is_known(0.0)) return {0.0};
    std::vector<double> gains = score_gains(model_.job);
    if (const auto close = close_gain(model_.job, values_of(model_.fit), context_))
      gains.push_back(*close);
    std::erase_if(gains, is_known);
    return gains;
  }

  const SearchOptions::Round& limits() const { return context_.options.round; }
  Strictness strictness() const { return {result_.tried, options_.chance}; }
  /// However lenient the round is.
  Strictness strict() const { return {result_.tried, context_.options.acceptance.chance}; }

  const Scored& entry(std::size_t place) const { return memory_.list->entries[place]; }

  bool is_excluded(const Hypothesis& hypothesis) const {
    return std::ranges::any_of(options_.excluded,
                               [&](const Hypothesis& c) { return is_same_form(c, hypothesis); });
  }

  void score_first() {
    if (!memory_.list) memory_.list = scored({first_gain()});
  }

  /// Two plain laws that explain most of what is missing, if none does alone, and pass.
  std::optional<TriedPair> large_pair() {
    if (is_exact_ || leaves_little(model_, context_.options) || memory_.has_no_large_pair)
      return std::nullopt;
    score_first();
    const Shortlist& list = *memory_.list;
    memory_.has_no_large_pair = true;
    if (list.has_most) return std::nullopt;
    std::vector<Shortlist::Promise> hypotheses = list.promises;
    std::erase_if(hypotheses, [&](const Shortlist::Promise& p) {
      return p.hypothesis->kind != HypothesisKind::effect || p.hypothesis->parameters() > 1 ||
             is_excluded(*p.hypothesis);
    });
    if (hypotheses.empty()) return std::nullopt;
    const auto pairs = score_pairs(model_, std::array{first_gain()}, hypotheses, context_);
    const auto best = std::ranges::max_element(pairs, {}, &ScoredPair::gain);
    if (best == pairs.end() || !best->is_most) return std::nullopt;
    const double alone = std::ranges::max(list.promises, {}, &Shortlist::Promise::gain).gain;
    if (best->gain < limits().pair_times * alone) return std::nullopt;
    report_progress("trying " + best->first.hypothesis->name + " and " +
                    best->second.hypothesis->name);
    return try_pair(model_, *best, context_);
  }

  /// The places in the shortlist of what is to be refitted.
  std::vector<std::size_t> choice() {
    score_first();
    if (!std::exchange(memory_.is_compared, true)) {
      fit_entries_from_afar();
      if (!memory_.list->has_most) score_the_rest();
      memory_.refits.resize(memory_.list->entries.size());
    }
    result_.tried = memory_.list->tried;
    std::vector<std::size_t> places(memory_.list->entries.size());
    std::iota(places.begin(), places.end(), 0);
    std::erase_if(places, [&](std::size_t place) {
      return is_hopeless(entry(place)) || is_excluded(*entry(place).hypothesis);
    });
    return places;
  }

  Shortlist scored(const std::vector<double>& gains) const {
    report_progress("scoring effects", 0, 0, Work::scores);
    return shortlist(model_.job, values_of(model_.fit), gains, options_.curves, context_,
                     memory_.list.has_value());
  }

  /// At other gains, the free run first, until one effect promises most of what is missing; whether
  /// there were any.
  bool score_the_rest() {
    bool is_any = false;
    while (!memory_.is_whole && !(is_any && memory_.list->has_most)) {
      const std::vector<double> gains = other_gains();
      memory_.is_whole = gains != std::vector{0.0};
      if (gains.empty()) break;
      is_any = true;
      memory_.list->add(scored(gains), context_.options);
      fit_entries_from_afar();
    }
    memory_.refits.resize(memory_.list->entries.size());
    return is_any;
  }

  /// Where refits are costly and fail, the entries are told apart by fits that track, which take a
  /// few steps.
  void fit_entries_from_afar() {
    if (is_exact_ || !is_lost(model_, context_.options)) return;
    report_progress("comparing effects", 0, 0, Work::scores);
    fit_entries(*memory_.list, model_.job, values_of(model_.fit), search_gain(model_.job),
                context_);
  }

  /// Whether the acceptance test would find it no better than chance. A score holds to
  /// first order: the refit may find more, above all where the score is large.
  bool is_hopeless(const Scored& entry) const {
    const double least = least_gain(*entry.hypothesis, samples_of(before_), result_.tried);
    if (is_exact_) return entry.scaled_gain < least;
    return entry.promise < limits().promise * least && entry.scaled_gain < limits().much * least;
  }

  /// When an entry is refitted: the first three until one passes that leaves nothing but noise.
  enum class Turn {
    simpler,  ///< than the best, which it would go before if it does as well
    best,
    near_it,
    less,    ///< it promises little beside the best: only where none of the above passes
    second,  ///< a simpler one promises as much: likewise
  };

  Turn turn_of(const Scored& entry, const Scored& best) const {
    const Hypothesis &own = *entry.hypothesis, &other = *best.hypothesis;
    if (&entry == &best) return Turn::best;
    if (is_plain_beside(own, other)) return Turn::simpler;
    if (entry.is_second) return Turn::second;
    if (entry.scaled_gain < limits().rival_part * best.scaled_gain) return Turn::less;
    const bool goes_before =
        own.kind == HypothesisKind::clock || own.parameters() < other.parameters();
    return goes_before ? Turn::simpler : Turn::near_it;
  }

  void refit_in_turns(std::vector<std::size_t> places) {
    const Scored* best = nullptr;
    for (const std::size_t place : places)
      if (const Scored& e = entry(place);
          !e.is_second && (best == nullptr || e.scaled_gain > best->scaled_gain))
        best = &e;
    const auto turn = [&](std::size_t place) {
      return best == nullptr ? Turn::second : turn_of(entry(place), *best);
    };
    std::erase_if(places, [&](std::size_t place) {
      return turn(place) > Turn::near_it && best != nullptr &&
             entry(place).scaled_gain < limits().least_part * best->scaled_gain;
    });
    std::ranges::stable_sort(places, {}, [&](std::size_t place) {
      return std::pair(turn(place), -entry(place).scaled_gain);
    });
    auto next = places.begin();
    while (next != places.end()) {
      const bool none_passes = all_are_rejected(result_.models);
      if (!none_passes && (turn(*next) > Turn::near_it || any_explains())) break;
      if (turn(*next) > Turn::near_it && has_seen_enough()) break;
      const auto end = std::ranges::upper_bound(next, places.end(), turn(*next), {}, turn);
      // Of what promises about as much the best is wanted, not the first that will do.
      const std::ptrdiff_t at_once = turn(*next) > Turn::near_it ? limits().at_once : end - next;
      next = refit_while_open(next, end, at_once);
    }
    // What leaves more than noise may be the plain form of a richer law.
    const auto is_richer = [&](std::size_t place) { return is_richer_form(entry(place)); };
    if (std::any_of(next, places.end(), is_richer) && !any_explains()) {
      const auto rest = std::stable_partition(next, places.end(), is_richer);
      next = refit_while_open(next, rest, rest - next);
    }
    for (; next != places.end(); ++next)
      if (turn(*next) != Turn::less) result_.unrefitted.push_back(entry(*next));
  }

  using Place = std::vector<std::size_t>::iterator;

  /// So many at once, until one that passes leaves nothing but noise, as none does yet; returns the
  /// first of the rest.
  Place refit_while_open(Place next, Place end, std::ptrdiff_t at_once) {
    while (next != end) {
      const auto few = next + std::min(end - next, at_once);
      const std::size_t known = result_.models.size();
      refit_all({next, few});
      reject_what_does_harm(known);
      next = few;
      if (next != end && (any_explains() || has_seen_enough()))
        break;  // which may take a simulation to tell
    }
    return next;
  }

  /// Whether nothing else is likely to pass. Where the fitted recordings hold little but noise what
  /// promises most was tried; what takes all but noise away is what is missing, though they may
  /// leave open what it is like.
  bool has_seen_enough() const {
    using enum Rejection::Test;
    if (is_fitted_to_noise(before_) || leaves_little(model_, context_.options))
      return result_.models.size() >= limits().most_in_noise;
    return std::ranges::any_of(result_.models, [](const Tried& e) {
      return e.rejection && (e.rejection->test == strength || e.rejection->test == shape) &&
             is_fitted_to_noise(e.residuals);
    });
  }

  /// Whether it is one that passes, with more shapes.
  bool is_richer_form(const Scored& entry) const {
    return std::ranges::any_of(result_.models, [&](const Tried& e) {
      return !e.rejection && is_same(e.hypothesis, *entry.hypothesis) &&
             e.hypothesis.shapes.size() < entry.hypothesis->shapes.size();
    });
  }

  /// Whether one that passes leaves nothing but noise.
  bool any_explains() const {
    return std::ranges::any_of(result_.models, [](const Tried& e) {
      return !e.rejection && explains(FittedModel{"", e.job, e.fit});
    });
  }

  /// The reduced cost above which a refit is clearly worse than the best that passes.
  double worthless_cost_here() const {
    double cost = INFINITY;
    for (const Tried& e : result_.models)
      if (!e.rejection)
        cost = std::min(
            cost, worthless_cost(e.fit, e.residuals, e.hypothesis.parameters(), context_.options));
    return cost;
  }

  /// The reduced cost above which a refit with it is no better than chance, by half of what the
  /// acceptance test asks.
  double chance_cost(const Hypothesis& hypothesis) const {
    const double samples = samples_of(before_);
    const double least = least_gain(hypothesis, samples, result_.tried);
    return reduced_cost(model_.fit) - 0.5 * least * unit_ / std::max(1.0, samples);
  }

  /// Refits with each of these and judges it.
  void refit_all(std::span<const std::size_t> places) {
    std::vector<Tried>& models = result_.models;
    const std::size_t first = models.size();
    models.resize(first + places.size());
    // The longest first, so that no thread waits for it at the end.
    std::vector<std::size_t> order(places.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) {
      return entry(places[i]).hypothesis->parameters();
    });
    const double worthless = worthless_cost_here();
    int done = 0;
    std::mutex mutex;
    parallel_for(order.size(), [&](std::size_t k) {
      const std::size_t place = places[order[k]];
      const auto report = [&](int step) {
        const std::lock_guard lock(mutex);
        done += step;
        report_progress("trying " + entry(place).hypothesis->name, done,
                        static_cast<int>(places.size()));
      };
      report(0);
      Tried& e = models[first + order[k]];
      e = refitted(place, worthless);
      judge(e, before_, strictness(), context_.options);
      if (is_cut_short(e)) {
        resume(e, context_);
        memory_.refits[place] = e;
        judge(e, before_, strictness(), context_.options);
      }
      if (may_have_another_period(e)) try_other_periods(e, place);
      report(1);
    });
  }

  /// A ripple does nearly as well with one period more or less along the motion, and stays there:
  /// whether it gains beyond doubt and yet leaves more than noise, or was given up.
  bool may_have_another_period(const Tried& e) const {
    constexpr double kBeyondDoubt = 2.0;
    const double least = least_gain(e.hypothesis, e.gain.samples, result_.tried);
    return e.hypothesis.has_phase && !e.hypothesis.estimated_shapes().empty() && !is_exact_ &&
           e.gain.comparable && e.gain.fit_gain > kBeyondDoubt * least &&
           !is_fitted_to_noise(e.residuals);
  }

  /// Exchanges a refit for a better one with such a period.
  void try_other_periods(Tried& e, std::size_t place) {
    const double count = periods_passed(e.job, e.fit, e.hypothesis);
    const HypothesisValues found = values_in(e);
    const std::vector<double> values = values_of(e.fit);
    const bool is_length = quantity_list()[e.hypothesis.shapes.front()].quantity.unit == "m";
    for (const double other : {count - 1.0, count + 1.0}) {
      if (other < 1.0) continue;
      Scored start = entry(place);
      start.others.assign(values.begin(), values.begin() + std::ssize(model_.job.free));
      start.own = {e.hypothesis.neutral, found.shapes};
      start.own.shapes.front() *= is_length ? count / other : other / count;
      Tried next =
          try_hypothesis(model_.job, start, context_,
                         {.give_up_above = worthless_cost(e.fit, e.residuals, 0, context_.options),
                          .before = &model_.fit});
      judge(next, before_, strictness(), context_.options);
      if (next.fit.is_usable() && bic_advantage(next, e) > 0.0) memory_.refits[place] = e = next;
    }
  }

  /// Whether a refit promises to pass, but for want of iterations.
  bool is_cut_short(const Tried& e) const {
    return e.fit.verdict.kind == FitVerdict::Kind::no_minimum && !e.is_outdone &&
           e.gain.comparable && e.gain.p_value < options_.chance &&
           e.gain.fit_gain > least_gain(e.hypothesis, e.gain.samples, result_.tried);
  }

  /// With an entry of the shortlist, given up above a reduced cost at which it is worthless, or no
  /// better than chance.
  Tried refitted(std::size_t place, double worthless) {
    std::optional<Tried>& known = memory_.refits[place];
    if (known) return *known;
    const double chance = chance_cost(*entry(place).hypothesis);
    const bool may_be_nearby = is_close() && model_.job.options.is_continued();
    Tried tried = try_hypothesis(model_.job, entry(place), context_,
                                 {.give_up_above = std::min(worthless, chance),
                                  .before = &model_.fit,
                                  .is_nearby = may_be_nearby});
    const double cost = reduced_cost(tried.fit);
    tried.is_outdone = !tried.fit.is_usable() && cost > worthless && cost < chance;
    if (!tried.is_outdone) known = tried;  // another round may lack what outdid it
    return tried;
  }

  /// An error of an instrument or of time may follow a recording more closely and yet ask for a
  /// larger force that the machine does not have; a force beside the like of it may leave both
  /// open. Looks at the refits from `first` on.
  void reject_what_does_harm(std::size_t first = 0) {
    for (Tried& e : std::span(result_.models).subspan(first)) {
      if (e.rejection) continue;
      if ((e.rejection = rejection_by_free_run(model_.fit, e.fit)) ||
          (e.rejection = rejection_as_indistinct(model_.fit, e.fit)))
        continue;
      if (!force_before_) force_before_ = missing_percents(model_.job, model_.fit);
      e.rejection = rejection_by_force(*force_before_, missing_percents(e.job, e.fit),
                                       context_.options.acceptance);
    }
  }

  /// Drops all but one of several settings of one effect.
  void keep_the_best_setting() {
    const auto is_preferred = [](const Tried& a, const Tried& b) {
      if (a.rejection.has_value() != b.rejection.has_value()) return !a.rejection;
      return bic_advantage(a, b) > 0.0;
    };
    std::vector<Tried> kept;
    for (Tried& e : result_.models) {
      const auto other = std::ranges::find_if(
          kept, [&](const Tried& c) { return is_same(c.hypothesis, e.hypothesis); });
      if (other == kept.end())
        kept.push_back(std::move(e));
      else if (is_preferred(e, *other))
        *other = std::move(e);
    }
    result_.models = std::move(kept);
  }

  void choose() {
    const Tried* best = nullptr;
    for (const Tried& e : result_.models)
      if (!e.rejection && (best == nullptr || bic_advantage(e, *best) > 0.0)) best = &e;
    if (best == nullptr) return;
    const auto is_equal = [&](const Tried& e) {
      return !e.rejection && !is_clearly_worse(bic_advantage(*best, e), context_.options);
    };
    // A simpler effect that does as well goes first.
    for (const Tried& e : result_.models)
      if (e.hypothesis.parameters() < best->hypothesis.parameters() && is_equal(e)) best = &e;
    // So does a clock that is a little off: that is no part of the machine.
    for (const Tried& e : result_.models)
      if (best->hypothesis.kind != HypothesisKind::clock &&
          e.hypothesis.kind == HypothesisKind::clock && is_equal(e))
        best = &e;
    result_.best = static_cast<std::size_t>(best - result_.models.data());
  }

  const FittedModel& model_;
  const RoundOptions& options_;
  RoundMemory& memory_;
  const SearchContext& context_;
  const std::vector<ResidualSeries> before_;
  const double unit_;    ///< of least_unit()
  const bool is_exact_;  ///< nothing but noise is left, or so little that a score is exact
  std::optional<std::vector<double>> force_before_{};  ///< of missing_percents()
  RoundResult result_;
};

}  // namespace

RoundResult try_round(const FittedModel& model, const RoundOptions& options, RoundMemory& memory,
                      const SearchContext& context) {
  return RoundTrial(model, options, memory, context).run();
}

}  // namespace axisfit
