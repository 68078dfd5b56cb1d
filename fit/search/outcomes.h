// What became of the hypotheses that were refitted.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fit/search/closed_form.h"
#include "fit/search/tried.h"

namespace axisfit {

enum class Decision {
  accepted,
  undecided,  ///< explains the data as well as another effect: one of them is in the model
  rejected,
};

/// What a decision on a hypothesis rests on.
enum class Reason {
  // Accepted
  explains_best,    ///< of all that were tried in its round
  replicates,       ///< the recordings to validate, fitted by themselves, tell the same of it
  shown_by_blocks,  ///< held out from the fitted recordings, since those to validate could not
  explains_beside,  ///< the other: each hides the other while one is missing
  // Undecided
  explains_equally,  ///< as well as the other
  // Rejected
  failed_test,     ///< Outcome::rejection
  explains_less,   ///< than the other
  replaced,        ///< by the other, which explains more
  is_equal_delay,  ///< explains as well as the other: which of two delays it is matters little
  not_needed,      ///< any longer, with the effects that were accepted after it
  falls_with,      ///< the other, which was taken out: as its equal, or as found beside it
};

Decision decision_on(Reason reason);

/// One hypothesis that was refitted, and what became of it.
struct Outcome {
  Hypothesis hypothesis;
  int round = 0;
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

  Decision decision() const { return decision_on(reason); }
};

/// Of every hypothesis its last outcome.
class Outcomes {
 public:
  Outcomes() = default;
  explicit Outcomes(std::vector<Outcome> list) : list_(std::move(list)) {}

  const std::vector<Outcome>& list() const { return list_; }

  /// Enters what became of a hypothesis in a round that added `best`, or nothing (null).
  void record(const Tried& tried, const Tried* best, int round);
  /// Enters two that passed together.
  void record_pair(const Tried& first, const Tried& second, int round);
  /// Null for one that was never refitted.
  Outcome* find(const Hypothesis& hypothesis);
  /// Writes down that one is out, and why, and with it those that it explained as well as; does
  /// nothing where it was never refitted.
  void reject(const Hypothesis& hypothesis, Reason reason, const std::string& other = "");
  void fail(const Hypothesis& hypothesis, const Rejection& rejection);
  /// What became of one became of another, of the same law, whose parameters are the last of these.
  void rename(const Hypothesis& hypothesis, const Hypothesis& other,
              const std::vector<ParameterResult>& parameters);
  /// Writes down that two explain the recordings equally well; the first stays in the model.
  void leave_undecided(const Hypothesis& chosen, const Hypothesis& rival);

 private:
  Outcome* decide(const Hypothesis& hypothesis, Reason reason, std::optional<Rejection> rejection,
                  const std::string& other);

  std::vector<Outcome> list_;
};

}  // namespace axisfit
