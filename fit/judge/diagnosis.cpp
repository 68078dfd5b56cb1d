#include "fit/judge/diagnosis.h"

#include <algorithm>

namespace axisfit {

Diagnosis diagnose(const Job& job, const FitResult& result) {
  Diagnosis diagnosis;
  diagnosis.tests = test_residuals(job, result);
  diagnosis.explained =
      !diagnosis.tests.empty() && std::ranges::all_of(diagnosis.tests, &SeriesTest::explained);
  diagnosis.forces = missing_forces(job, result);
  return diagnosis;
}

}  // namespace axisfit
