// What a search takes away again of the effects that it accepted.
#pragma once

#include <optional>

#include "fit/search/search_state.h"

namespace axisfit {

/// Takes out the first effect that has become a simpler one beside those accepted after it, and
/// returns it, not to be tried again: the simpler one is in the catalogue.
std::optional<Candidate> drop_degenerate(SearchState& state);

/// Takes away what is not needed any more, or never was but to a simulation that tracks. Where the
/// fit stays far from the noise, what the recordings to validate tell alike beside all other
/// effects is needed.
void eliminate_backward(SearchState& state, const RunContext& context);

/// Where the fit stays far from the noise, a flexible effect lowers every error a little, whatever
/// is missing: named is only what accounts for a good part of it, or what other recordings show
/// alike.
void drop_imitators(SearchState& state, const RunContext& context);

/// Of a model that takes less than this share of the error away, in per cent, no part is named but
/// what other recordings show alike; and no instrument, which takes the blame for a part of the
/// machine in all alike.
void drop_unreplicated_of_a_poor_model(SearchState& state, double least_share,
                                       const RunContext& context);

/// Drops effects with another period elsewhere: a period is what an effect with a phase is known
/// by.
void drop_other_periods(SearchState& state, const RunContext& context);

/// Why no effect is named of a model that takes less than this share of the error away.
std::optional<Rejection> rejection_of_all(SearchState& state, double least_share);

/// Enters in the trials what the recordings to validate, fitted by themselves, say of what was
/// accepted.
void record_replications(SearchState& state, const RunContext& context);

}  // namespace axisfit
