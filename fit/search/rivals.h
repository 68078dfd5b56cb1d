// Hypotheses that explain the recordings as well as an accepted one, or better.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "fit/search/search_state.h"

namespace axisfit {

/// A model with another hypothesis in the place of an accepted one.
struct TriedRival {
  std::size_t place = 0;  ///< of the accepted one
  Tried tried;
};

/// The first accepted hypothesis that has a clearly better rival, which passes the acceptance test
/// among so many tried; none where there is no such.
std::optional<TriedRival> better_rival(SearchState& state, std::size_t tried,
                                       const SearchContext& context);

/// The equals of all accepted hypotheses, now that all else is known. Rivals without an outcome get
/// one, of this round.
std::vector<TriedRival> equal_rivals(SearchState& state, int round, const SearchContext& context);

/// Whether both do nothing, to first order, but to act later.
bool are_delays(const Hypothesis& a, const Hypothesis& b);

}  // namespace axisfit
