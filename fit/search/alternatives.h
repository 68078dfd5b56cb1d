// What else could be the cause: the constants that do the same as one that was corrected.
#pragma once

#include <vector>

#include "fit/estimate/estimate.h"
#include "fit/search/catalogue.h"

namespace axisfit {

/// A candidate of one strength that may stand in for another, and where to start its refit.
struct Alternative {
  Candidate candidate;
  double strength = 0.0;
  std::vector<double> values;  ///< of the job's free parameters but that of the candidate replaced
};

/// The candidates of one strength that imitate `accepted`, itself of one strength, at the fit of a
/// job that has it: with it back at its neutral value, they and the other free parameters make the
/// same of the simulation, to first order. Wrong data sheets are hard to tell apart: a heavier arm
/// and a weaker drive look alike, and two gains in series are one. At most four, the best first.
std::vector<Alternative> alternatives(const Job& job, const FitResult& fit,
                                      const Candidate& accepted,
                                      const std::vector<Candidate>& candidates);

}  // namespace axisfit
