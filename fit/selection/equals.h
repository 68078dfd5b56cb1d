// What estimates owe to the choice among effects that explain the recordings equally well.
#pragma once

#include "fit/selection/select_effects.h"

namespace axisfit {

/// Widens the standard errors and intervals of the selection's result: of parameters of the machine
/// that differ by more than their standard error where another effect stands in the place of one
/// that explains as much, the largest such move counts as a further, independent error, and
/// ParameterResult::equal_shift tells it. The effects' own parameters are left as they are.
void allow_for_equals(EffectSelection& selection);

}  // namespace axisfit
