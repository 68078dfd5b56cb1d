// Effects that explain the recordings as well as an accepted one, or better.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "fit/search/search_state.h"

namespace axisfit {

/// A model with another effect in the place of an accepted one.
struct Exchange {
  std::size_t place = 0;  ///< of the accepted effect
  ExtendedModel with_other;
};

/// The first accepted effect that has a clearly better rival, which passes the acceptance test
/// among so many tried; none where no effect has.
std::optional<Exchange> better_rival(SearchState& state, std::size_t tried,
                                     const RunContext& context);

/// An accepted effect and another that explains the recordings as well, now that all else is known.
struct RivalPair {
  std::size_t place = 0;  ///< of the accepted effect
  Candidate rival;
  Model<double> model;  ///< fitted with the rival in its place
  /// Both do nothing, to first order, but to act later.
  bool are_delays = false;
};

/// The equals of all accepted effects. Rivals without a trial get one, of this round.
std::vector<RivalPair> equal_rivals(SearchState& state, int round, const RunContext& context);

}  // namespace axisfit
