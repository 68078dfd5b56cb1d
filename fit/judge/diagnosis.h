// What a fit leaves unexplained, and where.
#pragma once

#include <vector>

#include "fit/judge/dependence.h"
#include "fit/judge/missing_force.h"

namespace axisfit {

struct Diagnosis {
  std::vector<SeriesTest> tests{};     ///< of every signal of every recording
  std::vector<MissingForce> forces{};  ///< of every recording
  bool explained = false;              ///< every series shows no more than its noise
};

/// Diagnoses a fit, also one that is not usable: what is missing shows all the more there.
Diagnosis diagnose(const Job& job, const FitResult& result);

}  // namespace axisfit
