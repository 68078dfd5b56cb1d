#include "fit/search/pruning.h"

#include <utility>
#include <vector>

namespace axisfit {
namespace {

/// What the recordings to validate, fitted by themselves, say of an effect; nothing where they
/// cannot be.
std::optional<Replication> found_elsewhere(SearchState& state, const Candidate& candidate,
                                           const RunContext& context) {
  if (!state.chain.has_elsewhere())
    state.report_progress(context, "do the recordings to validate tell the same?");
  const std::optional<FitResult>& elsewhere = state.chain.elsewhere();
  if (!elsewhere) return std::nullopt;
  return replication(state.current().job, state.current().fit, *elsewhere, candidate);
}

bool is_alike_elsewhere(SearchState& state, const Candidate& candidate, const RunContext& context) {
  const auto found = found_elsewhere(state, candidate, context);
  return found && found->is_alike;
}

}  // namespace

std::optional<Candidate> drop_degenerate(SearchState& state) {
  for (std::size_t a = 0; a < state.accepted().size(); ++a) {
    const Candidate candidate = state.accepted()[a].candidate;
    const auto shape = shape_at_bound(state.current().job, state.current().fit, candidate);
    if (!shape) continue;
    const SelectionStep& reduced = state.chain.without(a);
    if (!reduced.fit.usable) continue;
    state.trials.fail(candidate, {.test = Rejection::Test::bound, .parameter = shape});
    state.take_out(a, reduced);
    return candidate;
  }
  return std::nullopt;
}

void eliminate_backward(SearchState& state, const RunContext& context) {
  bool is_far = !state.chain.explained();
  const auto is_plain = [&](const AcceptedEffect& effect) {
    return is_far && is_alike_elsewhere(state, effect.candidate, context);
  };
  for (std::size_t a = 0; a < state.accepted().size();) {
    const AcceptedEffect& effect = state.accepted()[a];
    if (is_plain(effect)) {
      ++a;
      continue;
    }
    state.report_progress(context, "is " + effect.candidate.name + " necessary?");
    std::vector<std::size_t> doubted;
    for (std::size_t b = a; b < state.accepted().size(); ++b)
      if (!is_plain(state.accepted()[b])) doubted.push_back(b);
    state.chain.fit_without(doubted);
    const SelectionStep& reduced = state.chain.without(a);
    if (!reduced.fit.usable || is_needed(improvement(reduced, state.current()),
                                         effect.candidate.parameters(), effect.is_seen_elsewhere)) {
      ++a;
      continue;
    }
    state.trials.reject(effect.candidate, Reason::not_needed);
    state.take_out(a, reduced);
    is_far = !state.chain.explained();
    a = 0;
  }
}

void drop_imitators(SearchState& state, const RunContext& context) {
  constexpr double kLeastPercent = 25.0;
  while (!state.accepted().empty() && !state.chain.explained()) {
    std::optional<std::size_t> least;
    double percent = kLeastPercent;
    for (std::size_t a = 0; a < state.accepted().size(); ++a) {
      const Candidate& candidate = state.accepted()[a].candidate;
      if (candidate.is_curve || is_alike_elsewhere(state, candidate, context)) continue;
      state.report_progress(context, "what does " + candidate.name + " explain?");
      const SelectionStep& reduced = state.chain.without(a);
      if (!reduced.fit.usable) continue;
      const double explained = improvement(reduced, state.current()).missing_percent;
      if (explained >= percent) continue;
      percent = explained;
      least = a;
    }
    if (!least) return;
    state.trials.fail(state.accepted()[*least].candidate,
                      {.test = Rejection::Test::share, .found = percent});
    state.take_out(*least, state.chain.without(*least));
  }
}

void drop_unreplicated_of_a_poor_model(SearchState& state, double least_share,
                                       const RunContext& context) {
  const std::optional<Rejection> rejection = rejection_of_all(state, least_share);
  for (std::size_t a = 0; rejection && a < state.accepted().size();) {
    const Candidate candidate = state.accepted()[a].candidate;
    if (!candidate.is_instrument() && is_alike_elsewhere(state, candidate, context)) {
      ++a;
      continue;
    }
    state.trials.fail(candidate, *rejection);
    state.take_out(a, state.chain.without(a));
  }
}

void drop_other_periods(SearchState& state, const RunContext& context) {
  for (std::size_t a = 0; a < state.accepted().size();) {
    const Candidate candidate = state.accepted()[a].candidate;
    const auto found =
        candidate.has_phase ? found_elsewhere(state, candidate, context) : std::nullopt;
    if (!found || !found->has_other_period) {
      ++a;
      continue;
    }
    state.trials.fail(candidate,
                      {.test = Rejection::Test::period, .found = found->parameters.back().value});
    state.take_out(a, state.chain.without(a));
  }
}

std::optional<Rejection> rejection_of_all(SearchState& state, double least_share) {
  if (state.accepted().empty() || state.chain.explained()) return std::nullopt;
  const double percent = improvement(state.chain.declared(), state.current()).missing_percent;
  if (percent >= least_share) return std::nullopt;
  return Rejection{.test = Rejection::Test::share, .found = percent};
}

void record_replications(SearchState& state, const RunContext& context) {
  for (const AcceptedEffect& a : state.accepted())
    if (EffectTrial* trial = state.trials.find(a.candidate))
      if (auto found = found_elsewhere(state, a.candidate, context))
        trial->replication = std::move(found);
}

}  // namespace axisfit
