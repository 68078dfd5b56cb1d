// The experiment that discriminates between two models which explain the same recordings.
#pragma once

#include "fit/design/experiment.h"
#include "fit/search/select_effects.h"

namespace axisfit {

struct Discrimination {
  std::string chosen{}, rival{};  ///< the effects
  std::optional<Experiment>
      experiment{};                ///< the motion; none where a known one will do, or none does
  std::string recording{};         ///< the one whose motion will do; empty: none
  std::optional<Signal> signal{};  ///< in which they differ most; none: no motion discriminates
  double size = 0.0;               ///< rms of that difference, in units of the signal's noise
};

/// The signal and motion in which two rivals of a search differ most. It tries the motions of the
/// job's recordings, with the signals that they lack, and, if `new_motions` are safe to ask for,
/// the family of experiments that keep to the limits for all that the final fit leaves open, see
/// reach_of(). Limits are completed as for suggest_experiment. Differences are in units of the
/// job's noise of a signal, or, where it has none, in thousandths of its range. The models are
/// taken as fitted; refitting them to the new recording would make the difference smaller.
Discrimination discriminate(const EffectSelection& selection, const Substitution& rivals,
                            bool new_motions, const RunContext& context = {});

}  // namespace axisfit
