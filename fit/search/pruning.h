// What a search takes away again of the effects that it accepted.
#pragma once

#include <optional>

#include "fit/search/search_state.h"

namespace axisfit {

/// Takes out the first effect that has become a simpler one beside those accepted after it, not to
/// be tried again. Its plain rival takes its place, in this round; without one, the simpler one is
/// in the catalogue, and those accepted after it, which were found beside what it is not, go with
/// it. Whether there was one.
bool drop_degenerate(SearchState& state, int round, const SearchContext& context);

/// Takes away what is not needed any more, or never was but to a simulation that tracks. Where the
/// fit stays far from the noise, what the recordings to validate tell alike beside all other
/// effects is needed.
void eliminate_backward(SearchState& state, const SearchContext& context);

/// Where the fit stays far from the noise, a flexible effect lowers every error a little, whatever
/// is missing: named is only what accounts for a good part of it, what other recordings show alike,
/// or what repeats many times along the motion.
void drop_imitators(SearchState& state, const SearchContext& context);

/// A model that takes too little of the error away (SearchOptions::FarFromNoise) keeps only the
/// parts that other recordings show alike, and no instrument: that takes the blame for a part of
/// the machine in all of them.
void drop_unreplicated_of_a_poor_model(SearchState& state, const SearchContext& context);

/// Drops effects with another period elsewhere: a period is what an effect with a phase is known
/// by.
void drop_other_periods(SearchState& state, const SearchContext& context);

/// A second element of an effect, found beside a first that was taken out since, is the first: it
/// gets that name, and its parameters.
void name_as_first(SearchState& state, const SearchContext& context);

/// Takes out the effect whose strength the final fit, of which the search had a less accurate one,
/// leaves open the most: a bound holds it, or its interval, with scatter and the moves at other
/// gains, contains zero, and the recordings to validate do not tell the same. Whether there was
/// one.
bool drop_undetermined(SearchState& state, const FittedModel& last, const SearchContext& context);

/// Why no effect is named of a model that takes too little of the error away.
std::optional<Rejection> rejection_of_all(SearchState& state, const SearchOptions& options);

/// Enters in the outcomes what the recordings to validate, fitted by themselves, say of what was
/// accepted.
void record_replications(SearchState& state, const SearchContext& context);

}  // namespace axisfit
