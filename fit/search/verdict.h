// What a search comes to, in the words of SelectionVerdict.
#pragma once

#include "fit/search/search_state.h"
#include "fit/search/select_effects.h"

namespace axisfit {

/// Whether a declared parameter is at its bound, which makes up for what it is not, or most of the
/// drive force is missing, so that the simulation is elsewhere: effects then imitate what is wrong
/// with the model. Enters in the verdict which it is.
bool is_misfit(const SearchState& state, SelectionVerdict& verdict);

/// Enters what was accepted, and what remained undecided.
void enter_effects(const SearchState& state, const FittedModel& result, SelectionVerdict& verdict);

/// The kind of a selection of which all else is known. `is_noise`: nothing else is left of the
/// residual.
SelectionVerdict::Kind kind_of(const EffectSelection& selection, bool is_noise);

}  // namespace axisfit
