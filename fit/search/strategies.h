// What a search for effects tries, one strategy after another.
//
// A strategy is a function from the state where it begins to the state where it ends. A search
// (search()) runs them and keeps what explains the recordings better:
//
//   named           add the named effects that pass the acceptance test, one a round
//   together        find effects that mask each other while the simulation tracks the data, where
//                   it ran free; first of all where the free run is lost
//   with_curves     explain what is left by curves
//   from_a_curve    begin with a curve: named effects may have imitated a part of it
#pragma once

#include <optional>

#include "fit/search/round.h"
#include "fit/search/search_state.h"

namespace axisfit {

/// What the rounds of a search share: how they go about it, and what they have computed and
/// counted.
struct Rounds {
  SearchContext context;
  bool held_out_blocks = false;  ///< no recording is to validate, see with_held_out_blocks()
  /// The declared model that runs freely where a search begins with one that tracks in its place.
  std::optional<FittedModel> free{};
  RoundMemory of_names{}, of_curves{};
  int count = 0;  ///< of all strategies, those that were given up included
};

/// Adds named effects, each the one that explains the most, as long as one passes; where none does,
/// exchanges an accepted one for a clearly better rival, once. When it is stopped, what was
/// accepted by then is the result.
SearchState named(SearchState state, Rounds& rounds);

/// Several large effects mask each other: the free-running simulation drifts away from the data
/// whichever of them is added, and its residual says little. A simulation that tracks the data
/// stays near them. So the effects are found and judged while tracking, and then refitted together
/// by the criterion of the job. Each of them sees what else is missing as noise, so they are
/// judged leniently until all are known, and then strictly by backward elimination. Where nothing
/// is found that the state lacks, it is given up. Throws Interrupted.
SearchState together(SearchState state, Rounds& rounds);

/// Adds curves as long as one passes. When it is stopped, what was accepted by then is the result.
SearchState with_curves(SearchState state, Rounds& rounds);

/// Begins anew with a curve, then adds named effects beside it, to the declared model of the state.
/// Returns the state itself where no curve passes. Throws Interrupted.
SearchState from_a_curve(const SearchState& state, Rounds& rounds);

/// Runs the strategies from a declared model and chooses. When it is stopped, the latest state that
/// can be a result is.
SearchState search(SearchState declared, Rounds& rounds);

/// The model, refitted with a simulation that tracks the data at this observer gain.
FittedModel tracking(FittedModel model, double gain, const SearchContext& context);

}  // namespace axisfit
