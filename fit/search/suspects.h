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

}  // namespace axisfit
