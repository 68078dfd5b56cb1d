#include "fit/search/rivals.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "fit/search/alternatives.h"
#include "fit/search/round.h"
#include "fit/solve/parameters.h"

namespace axisfit {
namespace {

bool is_delay(const Candidate& candidate) {
  return !candidate.is_constant && candidate.strengths.size() == 1 &&
         quantity_list()[candidate.strengths.front()].quantity.unit == "s";
}

/// Whether they say the same of the machine, with other numbers: a drive's droop that is linear or
/// quadratic. Two channels are two causes.
bool is_form_of_same_effect(const Candidate& a, const Candidate& b) {
  const QuantityEntry& p = quantity_list()[a.strengths.front()];
  const QuantityEntry& q = quantity_list()[b.strengths.front()];
  return p.effect && p.effect == q.effect && p.quantity.channel == q.quantity.channel;
}

/// The constants that may be wrong in place of one that was corrected become its rivals.
void add_alternatives(AcceptedEffect& accepted, const SelectionStep& model) {
  if (!accepted.candidate.is_constant) return;
  for (Alternative& a :
       alternatives(model.job, model.fit, accepted.candidate, catalogue(model.job, {}))) {
    std::erase_if(accepted.rivals,
                  [&](const Rival& r) { return same_effect(r.candidate, a.candidate); });
    accepted.rivals.insert(accepted.rivals.begin(),
                           {a.candidate, {{a.strength}, {}}, std::move(a.values)});
  }
}

/// Where the fit of a rival starts: one that has not been fitted with the strengths that suit all
/// else as it is.
CandidateValues first_values(const Job& others, const Rival& rival, const RunContext& context) {
  if (!rival.values.strengths.empty()) return rival.values;
  const Candidate& candidate = rival.candidate;
  const Job alone = with_candidate(fixed_at(others, initial_values(others)), candidate, {},
                                   candidate.neutral, rival.values.shapes);
  const FitResult fit = refit(alone, context);
  if (!fit.usable) return {candidate.neutral, rival.values.shapes};
  return candidate_values(alone, fit, candidate);
}

/// Fits those of an accepted effect's rivals that `counts` in its place, from where all else is.
template <class Counts>
std::vector<ExtendedModel> fit_rivals(const SearchState& state, std::size_t place, Counts&& counts,
                                      const RunContext& context) {
  constexpr std::size_t kMost = 8;
  std::vector<Rival> rivals = state.accepted()[place].rivals;
  std::erase_if(rivals, [&](const Rival& rival) {
    return !counts(rival.candidate) ||
           std::ranges::any_of(state.accepted(), [&](const AcceptedEffect& other) {
             return same_effect(other.candidate, rival.candidate);
           });
  });
  std::vector<ExtendedModel> list(std::min(rivals.size(), kMost));
  if (list.empty()) return list;
  const Job others = state.chain.job_with_accepted(state.chain.declared().job, place);
  parallel_for(list.size(), [&](std::size_t i) {
    const Rival& rival = rivals[i];
    const CandidateValues first = first_values(others, rival, context);
    list[i] = fit_extended_model(others, rival.candidate,
                                 rival.others.empty() ? initial_values(others) : rival.others,
                                 first.strengths, first.shapes, context);
  });
  std::erase_if(list, [](const ExtendedModel& e) { return !e.fit.usable; });
  return list;
}

/// By how much it explains the recordings worse than the present model, whose residuals are given.
double loss_with(const ExtendedModel& e, const SelectionStep& present,
                 const std::vector<ResidualSeries>& residuals) {
  return bic_difference(residuals, present.job.free.size(), e.residuals, e.job.free.size());
}

}  // namespace

std::optional<Exchange> better_rival(SearchState& state, std::size_t tried,
                                     const RunContext& context) {
  const SelectionStep& present = state.current();
  const auto now = residual_series(present.job, present.fit);
  for (std::size_t a = 0; a < state.accepted().size(); ++a) {
    const AcceptedEffect& accepted = state.accepted()[a];
    if (accepted.rivals.empty()) continue;
    state.report_progress(context, "any better than " + accepted.candidate.name + "?");
    for (ExtendedModel& e : fit_rivals(
             state, a, [](const Candidate&) { return true; }, context)) {
      if (!is_clearly_worse(-loss_with(e, present, now))) continue;
      const SelectionStep& reduced = state.chain.without(a);
      judge(e, residual_series(reduced.job, reduced.fit), tried);
      if (!e.rejection) return Exchange{a, std::move(e)};
    }
  }
  return std::nullopt;
}

std::vector<RivalPair> equal_rivals(SearchState& state, int round, const RunContext& context) {
  std::vector<AcceptedEffect>& accepted = state.chain.accepted();
  if (accepted.empty()) return {};
  state.report_progress(context, "any equals?");
  const SelectionStep& present = state.current();
  for (AcceptedEffect& effect : accepted) add_alternatives(effect, present);
  // What leaves nothing but noise needs no more parameters.
  const bool is_noise = state.chain.explained();
  const auto has_more = [&](const Candidate& rival, std::size_t a) {
    return rival.parameters() > accepted[a].candidate.parameters();
  };
  std::vector<std::vector<ExtendedModel>> rivals(accepted.size());
  parallel_for(accepted.size(), [&](std::size_t a) {
    const Candidate& chosen = accepted[a].candidate;
    const auto counts = [&](const Candidate& rival) {
      // A clock that is off has precedence: no part of the machine is its equal.
      const bool is_behind = chosen.is_timing && !rival.is_timing;
      return !is_behind && !is_form_of_same_effect(chosen, rival) &&
             !(is_noise && has_more(rival, a));
    };
    rivals[a] = fit_rivals(state, a, counts, context);
  });
  const auto now = residual_series(present.job, present.fit);
  std::vector<RivalPair> pairs;
  for (std::size_t a = 0; a < accepted.size(); ++a) {
    for (const ExtendedModel& e : rivals[a]) {
      // More parameters must explain more than they cost.
      const double loss = loss_with(e, present, now);
      if (has_more(e.candidate, a) ? loss >= 0.0 : is_clearly_worse(loss)) continue;
      if (state.trials.find(e.candidate) == nullptr) state.trials.record(e, &e, round);
      pairs.push_back({a, e.candidate, fitted_model(e.job, e.fit),
                       is_delay(accepted[a].candidate) && is_delay(e.candidate)});
    }
  }
  return pairs;
}

}  // namespace axisfit
