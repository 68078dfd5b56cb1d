// What a fit without a search suspects.
#pragma once

#include <vector>

#include "fit/estimate/estimate.h"
#include "fit/search/options.h"
#include "fit/search/scored.h"

namespace axisfit {

/// The few hypotheses that would explain most of the residual, by one score test of the catalogue,
/// strongest first (SearchOptions::Scoring): suspicions, not findings.
std::vector<Scored> suspected_effects(const Job& job, const FitResult& fit,
                                      const SearchContext& context = {});

/// The one that may be called the likely cause; null where the best of them explains too little:
/// almost anything explains a little of what something else leaves.
const Scored* likely_cause(const std::vector<Scored>& suspects,
                           const SearchOptions::Scoring& options = {});

}  // namespace axisfit
