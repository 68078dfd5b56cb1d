// What estimates owe to the choice between an effect and its rivals.
#pragma once

#include "fit/search/select_effects.h"

namespace axisfit {

/// Widens the standard errors and intervals of the selection's result. Parameters of the machine
/// that differ by more than their standard error with a rival in the place of the chosen effect are
/// given the largest such move as a further, independent error: ParameterResult::rival_shift tells
/// it. The effect's own parameters are left as they are.
void allow_for_rivals(EffectSelection& selection);

}  // namespace axisfit
