#include "fit/selection/diagnosis.h"

#include <algorithm>

#include "fit/selection/score.h"

namespace axisfit {

Diagnosis diagnose(const Job& job, const FitResult& result, const RunContext& context) {
  Diagnosis diagnosis;
  diagnosis.tests = test_residuals(job, result);
  diagnosis.explained =
      !diagnosis.tests.empty() && std::ranges::all_of(diagnosis.tests, &SeriesTest::explained);
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    diagnosis.forces.push_back(missing_force(job, result, r));
  if (diagnosis.explained) return diagnosis;
  const ScoreTest test =
      score_test(job, values_of(result), score_gains(job).front(), false, context);
  constexpr std::size_t kSuspects = 5;
  constexpr double kMinFraction = 0.02;
  for (const Score& score : test.scores) {
    const Candidate& candidate = test.candidates[score.candidate];
    const double fraction = score.gain / test.sum_of_squares;
    if (diagnosis.suspected_effects.size() == kSuspects || !(fraction >= kMinFraction)) break;
    const bool known = std::ranges::any_of(
        diagnosis.suspected_effects,
        [&](const SuspectedEffect& s) { return same_effect(s.candidate, candidate); });
    if (!known)
      diagnosis.suspected_effects.push_back({candidate, score.shapes, score.strengths, fraction});
  }
  return diagnosis;
}

}  // namespace axisfit
