#include "fit/search/outcomes.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace axisfit {

Decision decision_on(Reason reason) {
  switch (reason) {
    case Reason::explains_best:
    case Reason::replicates:
    case Reason::shown_by_blocks:
    case Reason::explains_beside:
      return Decision::accepted;
    case Reason::explains_equally:
      return Decision::undecided;
    case Reason::failed_test:
    case Reason::explains_less:
    case Reason::replaced:
    case Reason::is_equal_delay:
    case Reason::not_needed:
    case Reason::falls_with:
      break;
  }
  return Decision::rejected;
}

void Outcomes::record(const Tried& tried, const Tried* best, int round) {
  Outcome outcome;
  outcome.hypothesis = tried.hypothesis;
  outcome.round = round;
  outcome.score = tried.score;
  outcome.improvement = tried.gain;
  const std::size_t first = tried.job.free.size() - tried.hypothesis.parameters();
  outcome.parameters.assign(tried.fit.parameters.begin() + static_cast<std::ptrdiff_t>(first),
                            tried.fit.parameters.end());
  if (&tried == best) {
    outcome.in_model = true;
    outcome.reason = tried.replication ? Reason::replicates
                     : tried.on_blocks ? Reason::shown_by_blocks
                                       : Reason::explains_best;
    outcome.replication = tried.replication;
  } else if (tried.rejection && !(tried.is_outdone && best != nullptr)) {
    outcome.rejection = tried.rejection;
  } else {
    outcome.reason = Reason::explains_less;
    outcome.other = best->hypothesis.name;
  }
  if (Outcome* known = find(tried.hypothesis))
    *known = std::move(outcome);
  else
    list_.push_back(std::move(outcome));
}

void Outcomes::record_pair(const Tried& first, const Tried& second, int round) {
  for (const auto& [tried, other] : {std::pair(&first, &second), std::pair(&second, &first)}) {
    record(*tried, tried, round);
    Outcome& outcome = *find(tried->hypothesis);
    outcome.reason = Reason::explains_beside;
    outcome.other = other->hypothesis.name;
  }
}

Outcome* Outcomes::find(const Hypothesis& hypothesis) {
  const auto found = std::ranges::find_if(
      list_, [&](const Outcome& o) { return is_same(o.hypothesis, hypothesis); });
  return found == list_.end() ? nullptr : &*found;
}

void Outcomes::rename(const Hypothesis& hypothesis, const Hypothesis& other,
                      const std::vector<ParameterResult>& parameters) {
  std::erase_if(list_, [&](const Outcome& o) { return is_same(o.hypothesis, other); });
  Outcome* outcome = find(hypothesis);
  if (outcome == nullptr) return;
  outcome->hypothesis = other;
  outcome->parameters.assign(parameters.end() - static_cast<std::ptrdiff_t>(other.parameters()),
                             parameters.end());
}

Outcome* Outcomes::decide(const Hypothesis& hypothesis, Reason reason,
                          std::optional<Rejection> rejection, const std::string& other) {
  Outcome* outcome = find(hypothesis);
  if (outcome == nullptr) return nullptr;
  outcome->reason = reason;
  outcome->rejection = rejection;
  outcome->other = other;
  outcome->in_model = false;
  if (decision_on(reason) == Decision::rejected)
    for (Outcome& equal : list_)
      if (equal.decision() == Decision::undecided && equal.other == hypothesis.name)
        equal.reason = Reason::falls_with;
  return outcome;
}

void Outcomes::reject(const Hypothesis& hypothesis, Reason reason, const std::string& other) {
  decide(hypothesis, reason, std::nullopt, other);
}

void Outcomes::fail(const Hypothesis& hypothesis, const Rejection& rejection) {
  decide(hypothesis, Reason::failed_test, rejection, "");
}

void Outcomes::leave_undecided(const Hypothesis& chosen, const Hypothesis& rival) {
  decide(rival, Reason::explains_equally, std::nullopt, chosen.name);
  if (Outcome* outcome = decide(chosen, Reason::explains_equally, std::nullopt, rival.name))
    outcome->in_model = true;
}

}  // namespace axisfit
