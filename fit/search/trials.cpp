#include "fit/search/trials.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace axisfit {

void Trials::record(const ExtendedModel& e, const ExtendedModel* best, int round) {
  EffectTrial trial;
  trial.candidate = e.candidate;
  trial.round = round;
  trial.score = e.score;
  trial.improvement = e.gain;
  const std::size_t first = e.job.free.size() - e.candidate.parameters();
  trial.parameters.assign(e.fit.parameters.begin() + static_cast<std::ptrdiff_t>(first),
                          e.fit.parameters.end());
  if (&e == best) {
    trial.decision = Decision::accepted;
    trial.in_model = true;
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
  if (EffectTrial* known = find(e.candidate))
    *known = std::move(trial);
  else
    list_.push_back(std::move(trial));
}

EffectTrial* Trials::find(const Candidate& candidate) {
  const auto found = std::ranges::find_if(
      list_, [&](const EffectTrial& t) { return same_effect(t.candidate, candidate); });
  return found == list_.end() ? nullptr : &*found;
}

EffectTrial* Trials::decide(const Candidate& candidate, Decision decision, Reason reason,
                            std::optional<Rejection> rejection, const std::string& other) {
  EffectTrial* trial = find(candidate);
  if (trial == nullptr) return nullptr;
  trial->decision = decision;
  trial->reason = reason;
  trial->rejection = std::move(rejection);
  trial->other = other;
  trial->in_model = false;
  return trial;
}

void Trials::reject(const Candidate& candidate, Reason reason, const std::string& other) {
  decide(candidate, Decision::rejected, reason, std::nullopt, other);
}

void Trials::fail(const Candidate& candidate, Rejection rejection) {
  decide(candidate, Decision::rejected, Reason::failed_test, std::move(rejection), "");
}

void Trials::leave_undecided(const Candidate& chosen, const Candidate& rival) {
  constexpr auto kUndecided = Decision::undecided;
  decide(rival, kUndecided, Reason::explains_equally, std::nullopt, chosen.name);
  if (EffectTrial* trial =
          decide(chosen, kUndecided, Reason::explains_equally, std::nullopt, rival.name))
    trial->in_model = true;
}

}  // namespace axisfit
