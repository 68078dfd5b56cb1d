// The experiment that discriminates between two models which explain the same recordings.
#pragma once

#include "fit/design/experiment.h"
#include "fit/selection/select_effects.h"

namespace axisfit {

struct Discrimination {
  std::string chosen{}, rival{};  ///< the effects
  std::optional<Experiment>
      experiment{};                ///< the motion; none where a known one will do, or none does
  std::string recording{};         ///< the one whose motion will do; empty: none
  std::optional<Signal> signal{};  ///< in which they differ most; none: no motion discriminates
  double size = 0.0;               ///< rms of that difference, in units of the signal's noise
};

/// In which signal and motion two rivals of a loop differ most. Tried are the motions of the job's
/// recordings, with the signals that they lack, and the family of experiments within the limits
/// (completed as for suggest_experiment, by the final fit). Differences are counted in the job's
/// noise of a signal, or, where it has none, in thousandths of its range. The models are taken as
/// fitted; refitting them to the new recording would make the difference smaller.
Discrimination discriminate(const EffectSelection& selection, const UndecidedPair& rivals,
                            const RunContext& context = {});

}  // namespace axisfit
