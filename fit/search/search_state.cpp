#include "fit/search/search_state.h"

#include <utility>

namespace axisfit {

void SearchState::restart(FittedModel declared) {
  chain.restart(std::move(declared));
  outcomes = {};
  degenerate.clear();
}

void SearchState::strike_off(std::size_t place) {
  for (const Hypothesis& part : chain.erase(place)) outcomes.reject(part, Reason::not_needed);
}

void SearchState::take_out(std::size_t place, FittedModel reduced) {
  strike_off(place);
  chain.set_last(std::move(reduced));
}

void SearchState::exchange(std::size_t place, Tried other, int round) {
  outcomes.record(other, &other, round);
  strike_off(place);
  chain.accepted().push_back({other.hypothesis});
  chain.set_last({other.hypothesis.name, std::move(other.job), std::move(other.fit)});
}

void SearchState::rename(std::size_t place, const Hypothesis& other, FittedModel renamed) {
  const Accepted before = accepted()[place];
  outcomes.rename(before.hypothesis, other, renamed.fit.parameters);
  chain.erase(place);
  chain.accepted().push_back({other, {}, before.is_seen_elsewhere});
  chain.set_last(std::move(renamed));
}

void SearchState::take_out_all(const Rejection& rejection) {
  for (const Accepted& a : chain.accepted()) outcomes.fail(a.hypothesis, rejection);
  chain.restart(chain.declared());
}

void SearchState::report_progress(const RunContext& context, const std::string& phase,
                                  Work work) const {
  context.report({.phase = phase, .best = current().fit.reduced_chi_square, .work = work});
}

}  // namespace axisfit
