// The effects that were refitted, and what became of each.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/search/closed_form.h"
#include "fit/search/extended_model.h"

namespace axisfit {

enum class Decision {
  accepted,
  undecided,  ///< explains the data as well as another effect: one of them is in the model
  rejected,
};

/// What a decision on an effect rests on.
enum class Reason {
  failed_test,         ///< EffectTrial::rejection
  explains_best,       ///< of all that were tried in its round
  replicates,          ///< the recordings to validate, fitted by themselves, tell the same of it
  shown_by_stretches,  ///< held out from the fitted recordings, since those to validate could not
  explains_less,       ///< than the other
  replaced,            ///< by the other, which explains more
  explains_equally,    ///< as well as the other
  not_needed,          ///< any longer, with the effects that were accepted after it
};

/// One effect that was refitted, and what became of it.
struct EffectTrial {
  Candidate candidate;
  int round = 0;
  Decision decision = Decision::rejected;
  Reason reason = Reason::failed_test;
  std::optional<Rejection> rejection;       ///< of failed_test
  std::string other;                        ///< effect that it was compared with, see reason
  bool in_model = false;                    ///< accepted, or that of the undecided which stays
  double score = 0.0;                       ///< gain that the score test promised
  std::vector<ParameterResult> parameters;  ///< its own: of this trial, or of the final model
  Improvement improvement;                  ///< against the model before it
  /// Of an accepted effect, what the recordings to validate say of it by themselves.
  std::optional<Replication> replication{};
  std::optional<ClosedForm> closed_form{};  ///< of an accepted curve
};

/// Of every effect its last trial.
class Trials {
 public:
  const std::vector<EffectTrial>& list() const { return list_; }

  /// Enters the trial of an extended model in a round that added `best`, or nothing (null).
  void record(const ExtendedModel& e, const ExtendedModel* best, int round);
  /// Null for an effect that was never refitted.
  EffectTrial* find(const Candidate& candidate);
  /// Writes down that an effect is out, and why; does nothing where it has no trial.
  void reject(const Candidate& candidate, Reason reason, const std::string& other = "");
  void fail(const Candidate& candidate, Rejection rejection);
  /// Writes down that two explain the recordings equally well; the first stays in the model.
  void leave_undecided(const Candidate& chosen, const Candidate& rival);

 private:
  EffectTrial* decide(const Candidate& candidate, Decision decision, Reason reason,
                      std::optional<Rejection> rejection, const std::string& other);

  std::vector<EffectTrial> list_;
};

}  // namespace axisfit
