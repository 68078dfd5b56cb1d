// The substitutions of a selection, for the errors of its estimates.
#pragma once

#include <vector>

#include "fit/errors/rival_error.h"
#include "fit/search/select_effects.h"

namespace axisfit {

std::vector<RivalModels> rival_models(const EffectSelection& selection);

}  // namespace axisfit
