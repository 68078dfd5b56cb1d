// What else could be the cause: the constants that do the same as one that was corrected.
#pragma once

#include <vector>

#include "fit/estimate/estimate.h"
#include "fit/search/options.h"
#include "fit/search/scored.h"

namespace axisfit {

/// The hypotheses of one strength that imitate `accepted`, itself of one strength, at the fit of a
/// job that has it, and where their refits in its place start: with it back at its neutral value,
/// they and the other free parameters make the same of the simulation, to first order. Wrong data
/// sheets are hard to tell apart: a heavier arm and a weaker drive look alike, and two gains in
/// series are one. The best first, at most SearchOptions::Rivals::constants.
std::vector<Scored> imitators(const Job& job, const FitResult& fit, const Hypothesis& accepted,
                              std::vector<Hypothesis> hypotheses,
                              const SearchOptions& options = {});

}  // namespace axisfit
