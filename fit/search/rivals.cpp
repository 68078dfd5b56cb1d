#include "fit/search/rivals.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "fit/criterion/gains.h"
#include "fit/search/catalogue.h"
#include "fit/search/exchange_score.h"
#include "fit/search/imitators.h"
#include "fit/solve/parameters.h"

namespace axisfit {
namespace {

bool is_delay(const Hypothesis& hypothesis) {
  return hypothesis.kind != HypothesisKind::constant && hypothesis.strengths.size() == 1 &&
         quantity_list()[hypothesis.strengths.front()].quantity.unit == "s";
}

/// Whether they say the same of the machine, with other numbers: a drive's droop that is linear or
/// quadratic. Two channels are two causes.
bool is_form_of_same_effect(const Hypothesis& a, const Hypothesis& b) {
  const QuantityEntry& p = quantity_list()[a.strengths.front()];
  const QuantityEntry& q = quantity_list()[b.strengths.front()];
  return p.effect && p.effect == q.effect && p.quantity.channel == q.quantity.channel &&
         a.recording == b.recording;
}

/// The constants that may be wrong in place of one that was corrected become its rivals.
void add_imitators(Accepted& accepted, const FittedModel& model, const SearchOptions& options) {
  if (accepted.hypothesis.kind != HypothesisKind::constant) return;
  for (Scored& imitator :
       imitators(model.job, model.fit, accepted.hypothesis, catalogue(model.job, {}), options)) {
    std::erase_if(accepted.rivals, [&](const Scored& rival) {
      return is_same(*rival.hypothesis, *imitator.hypothesis);
    });
    accepted.rivals.insert(accepted.rivals.begin(), std::move(imitator));
  }
}

/// Where the refit of a rival starts: with strengths that suit all else as it is, where it has
/// none. These few need no continuation.
Scored with_strengths(Scored rival, const Job& others, const SearchContext& context) {
  if (!rival.own.strengths.empty()) return rival;
  const Hypothesis& hypothesis = *rival.hypothesis;
  rival.own.strengths = hypothesis.neutral;
  Job alone = with_hypothesis(fixed_at(others, initial_values(others)), hypothesis, {}, rival.own);
  if (alone.options.is_continued()) alone.options.criterion = Tracking{search_gain(alone)};
  const FitResult fit = refit(alone, context);
  if (fit.is_usable()) rival.own = values_in(alone, fit, hypothesis);
  return rival;
}

/// Refits those of an accepted hypothesis' rivals that `counts` in its place, from where all else
/// is.
template <class Counts>
std::vector<Tried> try_rivals(const SearchState& state, std::size_t place, Counts&& counts,
                              const SearchContext& context) {
  std::vector<Scored> rivals = state.accepted()[place].rivals;
  std::erase_if(rivals, [&](const Scored& rival) {
    return !counts(*rival.hypothesis) ||
           std::ranges::any_of(state.accepted(), [&](const Accepted& other) {
             return is_same_form(other.hypothesis, *rival.hypothesis);
           });
  });
  std::vector<Tried> list(std::min(rivals.size(), context.options.rivals.refitted));
  if (list.empty()) return list;
  const Job others = state.chain.job_with_accepted(state.chain.declared().job, place);
  const FittedModel& present = state.current();
  const auto residuals = residual_series(present.job, present.fit);
  const double worthless = worthless_cost(
      present.fit, residuals, state.accepted()[place].hypothesis.parameters(), context.options);
  // What does as well as a model that leaves noise alone is not far from it.
  const bool is_nearby = is_fitted_to_noise(residuals);
  parallel_for(list.size(), [&](std::size_t i) {
    const auto score = exchange_score(present, state.accepted(), others, rivals[i]);
    if (score && is_out_of_reach(*score, context.options)) return;
    Scored start = with_strengths(rivals[i], others, context);
    if (start.others.empty()) start.others = initial_values(others);
    list[i] = try_hypothesis(others, start, context,
                             {.give_up_above = worthless, .is_nearby = is_nearby});
  });
  std::erase_if(list, [](const Tried& t) { return !t.fit.is_usable(); });
  return list;
}

/// By how much it explains the recordings worse than the present model, whose residuals are given.
double loss_with(const Tried& tried, const FittedModel& present,
                 const std::vector<ResidualSeries>& residuals) {
  return bic_difference(residuals, present.job.free.size(), tried.residuals, tried.job.free.size());
}

}  // namespace

bool are_delays(const Hypothesis& a, const Hypothesis& b) { return is_delay(a) && is_delay(b); }

std::optional<TriedRival> better_rival(SearchState& state, const Shortlist& scores,
                                       const SearchContext& context) {
  const FittedModel& present = state.current();
  const auto now = residual_series(present.job, present.fit);
  const Strictness strictness{scores.tried, context.options.acceptance.chance};
  // Where nothing but noise is left a score is exact; elsewhere a refit may find more.
  const double part = state.explained() ? 1.0 : context.options.round.promise;
  for (std::size_t a = 0; a < state.accepted().size(); ++a) {
    const Accepted& accepted = state.accepted()[a];
    if (accepted.rivals.empty()) continue;
    state.report_progress(context.run, "any better than " + accepted.hypothesis.name + "?");
    const auto may_be_better = [&](const Hypothesis& rival) {
      const double more = static_cast<double>(rival.parameters()) -
                          static_cast<double>(accepted.hypothesis.parameters());
      const double needed = clear_difference(context.options) + more * std::log(samples_of(now));
      return scores.promised_by(rival).value_or(INFINITY) >= part * needed;
    };
    for (Tried& rival : try_rivals(state, a, may_be_better, context)) {
      if (!is_clearly_worse(-loss_with(rival, present, now), context.options)) continue;
      const FittedModel& reduced = state.chain.without(a);
      judge(rival, residual_series(reduced.job, reduced.fit), strictness, context.options);
      if (!rival.rejection) return TriedRival{a, std::move(rival)};
    }
  }
  return std::nullopt;
}

std::optional<Tried> plain_rival(const SearchState& state, std::size_t place,
                                 const SearchContext& context) {
  const auto is_plain = [&](const Hypothesis& rival) {
    return is_plain_beside(rival, state.accepted()[place].hypothesis);
  };
  std::optional<Tried> best;
  for (Tried& rival : try_rivals(state, place, is_plain, context))
    if (!best || bic_advantage(rival, *best) > 0.0) best = std::move(rival);
  return best;
}

std::vector<TriedRival> equal_rivals(SearchState& state, int round, const SearchContext& context) {
  std::vector<Accepted>& accepted = state.chain.accepted();
  if (accepted.empty()) return {};
  state.report_progress(context.run, "any equals?");
  const FittedModel& present = state.current();
  for (Accepted& one : accepted) add_imitators(one, present, context.options);
  // A model that leaves nothing but noise needs no more parameters.
  const bool is_noise = state.explained();
  const auto has_more = [&](const Hypothesis& rival, std::size_t a) {
    return rival.parameters() > accepted[a].hypothesis.parameters();
  };
  std::vector<std::vector<Tried>> rivals(accepted.size());
  parallel_for(accepted.size(), [&](std::size_t a) {
    const Hypothesis& chosen = accepted[a].hypothesis;
    const auto counts = [&](const Hypothesis& rival) {
      // A clock that is off has precedence: no part of the machine is its equal.
      const bool is_behind =
          chosen.kind == HypothesisKind::clock && rival.kind != HypothesisKind::clock;
      return !is_behind && !is_form_of_same_effect(chosen, rival) &&
             !(is_noise && has_more(rival, a));
    };
    rivals[a] = try_rivals(state, a, counts, context);
  });
  const auto now = residual_series(present.job, present.fit);
  std::vector<TriedRival> equals;
  for (std::size_t a = 0; a < accepted.size(); ++a) {
    for (Tried& rival : rivals[a]) {
      // More parameters must explain more than they cost.
      const double loss = loss_with(rival, present, now);
      if (has_more(rival.hypothesis, a) ? loss >= 0.0 : is_clearly_worse(loss, context.options))
        continue;
      // What has become a simpler law says no more than that.
      if (rejection_as_simpler(rival.job, rival.fit, rival.hypothesis, context.options)) continue;
      if (state.outcomes.find(rival.hypothesis) == nullptr)
        state.outcomes.record(rival, &rival, round);
      equals.push_back({a, std::move(rival)});
    }
  }
  return equals;
}

}  // namespace axisfit
