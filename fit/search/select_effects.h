// Effect selection: from the residual of a fit to the effects that the model lacks.
//
// Round by round: score every hypothesis of the catalogue (score.h), refit with each of the few
// most likely ones, apply the acceptance test (acceptance.h), keep the best (round.h). What the
// rounds are used for is in strategies.h. Then accepted effects are exchanged on trial for their
// rivals (rivals.h), and removed one by one on trial (backward elimination, pruning.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/estimate/horizon.h"
#include "fit/search/model_chain.h"
#include "fit/search/options.h"
#include "fit/search/outcomes.h"

namespace axisfit {

/// A rival in the place of an effect of the model that explains the recordings equally well: both
/// undecided, or of two clocks that may be off the chosen one accepted.
struct Substitution {
  std::string chosen, rival;
  Model<double> with_chosen, with_rival;  ///< fitted
};

/// What a search comes to.
struct SelectionVerdict {
  enum class Kind {
    no_usable_fit,     ///< of the baseline model: its residual says nothing about effects
    nothing_missing,   ///< the baseline model explains every signal
    hardly_anything,   ///< it does, but for effects that are significant and hardly matter
    effects_accepted,  ///< one or more
    stopped,           ///< before an effect was accepted
    undecided,         ///< none was accepted, but some that explain the recordings equally well
    none_passes,       ///< something is missing, but every effect was rejected
    misfit,            ///< the declared model does not fit, so that nothing can be said of effects
  };
  Kind kind = Kind::no_usable_fit;
  std::vector<std::string> accepted{}, undecided{};  ///< effects
  /// Significant, but rejected since they hardly lower the validation error.
  std::vector<std::string> small{};
  /// A constant of the axis file that was accepted to be another: both in the quantity's unit.
  struct Correction {
    ParameterId id;
    double declared = 0.0, value = 0.0;
    bool operator==(const Correction&) const = default;
  };
  std::vector<Correction> corrections{};
  /// Of misfit: a declared parameter that is at its bound, or else the recording of which so much
  /// of the drive force is missing.
  std::optional<ParameterId> at_bound{};
  std::optional<std::size_t> recording{};
  double force_percent = 0.0;
  /// Fall of the root mean square of what was not fitted, by the effects in the model together.
  double validate_percent = 0.0;

  bool operator==(const SelectionVerdict&) const = default;
};

struct EffectSelection {
  std::vector<FittedModel> models;  ///< the declared one first, then one for each accepted effect
  FittedModel result;               ///< the last of them, fitted to all samples
  std::vector<Outcome> effects;     ///< what became of every hypothesis that was refitted
  bool held_out_blocks = false;     ///< no recording to validate: blocks of the fitted were kept
  bool explained = false;           ///< nothing but noise is left, and no small effect
  bool interrupted = false;         ///< the search was stopped, and what it found not judged
  bool cut_short = false;  ///< it ended early (RunContext::end_search), and that was judged
  /// Where the job lets it be chosen and effects were accepted: by the model with them.
  std::optional<HorizonChoice> horizon;
  SelectionVerdict verdict;
  std::vector<Substitution> substitutions;
};

/// `first` is the fit of the job as declared. When the stop flag is set, the effects accepted
/// so far are the result; when the search is to end, these are judged first, as others are.
EffectSelection select_effects(const Job& job, const FitResult& first,
                               const SearchOptions& options = {}, const RunContext& context = {});

}  // namespace axisfit
