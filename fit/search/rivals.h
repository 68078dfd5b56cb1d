// Hypotheses that explain the recordings as well as an accepted one, or better.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "fit/search/search_state.h"
#include "fit/search/shortlist.h"

namespace axisfit {

/// A model with another hypothesis in the place of an accepted one.
struct TriedRival {
  std::size_t place = 0;  ///< of the accepted one
  Tried tried;
};

/// The first accepted hypothesis that has a clearly better rival, which passes the acceptance test;
/// none where there is no such. `scores` are those beside all that is accepted: a model with both
/// explains at least as much as one with the rival alone, so that a rival which promises little
/// beside the accepted one is no better in its place, and is not refitted.
std::optional<TriedRival> better_rival(SearchState& state, const Shortlist& scores,
                                       const SearchContext& context);

/// The best of the rivals with one strength and no shape in the place of an accepted hypothesis
/// that has more.
std::optional<Tried> plain_rival(const SearchState& state, std::size_t place,
                                 const SearchContext& context);

/// The equals of all accepted hypotheses, now that all else is known. Rivals without an outcome get
/// one, of this round.
std::vector<TriedRival> equal_rivals(SearchState& state, int round, const SearchContext& context);

/// Whether both do nothing, to first order, but to act later.
bool are_delays(const Hypothesis& a, const Hypothesis& b);

}  // namespace axisfit
