// What a fit leaves unexplained, where, and what it might be.
#pragma once

#include <vector>

#include "fit/judge/dependence.h"
#include "fit/judge/missing_force.h"
#include "fit/search/catalogue.h"

namespace axisfit {

/// An effect that the residual speaks for; a suspicion, not a finding.
struct SuspectedEffect {
  Candidate candidate;
  std::vector<double> shapes, strengths;  ///< as the score test sees them
  double fraction =
      0.0;  ///< of the sum of squares of the tracking simulation that it would explain
};

struct Diagnosis {
  std::vector<SeriesTest> tests;                   ///< of every signal of every recording
  std::vector<MissingForce> forces;                ///< of every recording
  bool explained = false;                          ///< every series shows no more than its noise
  std::vector<SuspectedEffect> suspected_effects;  ///< strongest first; may not be sought
};

/// Looks at a fit, also at one that is not usable: what is missing shows all the more there.
/// Without suspects.
Diagnosis diagnose(const Job& job, const FitResult& result);

/// Up to five effects that would explain most of the residual, by one score test of the catalogue,
/// strongest first.
std::vector<SuspectedEffect> suspected_effects(const Job& job, const FitResult& result,
                                               const RunContext& context = {});

}  // namespace axisfit
