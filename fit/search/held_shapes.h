// Shapes that accepted laws hold, such as an exponent that makes another law: they are not
// estimated, and looked at again beside what is accepted later.
#pragma once

#include <cstddef>
#include <vector>

#include "fit/search/search_state.h"

namespace axisfit {

/// Of what passes about as well as the best, one may be better beside other settings of what the
/// accepted laws hold: exchanges these in them, and returns the best. Where the best leaves nothing
/// but noise, or nothing is held, all stays as it is.
Tried* best_beside_held(Tried* best, std::vector<Tried>& models, const SearchState& state,
                        const SearchContext& context);

/// Looks at the settings that the first so many accepted laws hold again, beside what was accepted
/// since, as long as something is missing.
void reconsider_held(SearchState& state, std::size_t count, const SearchContext& context);

}  // namespace axisfit
