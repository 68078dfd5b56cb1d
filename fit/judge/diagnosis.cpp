#include "fit/judge/diagnosis.h"

#include <algorithm>

#include "fit/criterion/gains.h"
#include "fit/search/score.h"

namespace axisfit {

Diagnosis diagnose(const Job& job, const FitResult& result) {
  Diagnosis diagnosis;
  diagnosis.tests = test_residuals(job, result);
  diagnosis.explained =
      !diagnosis.tests.empty() && std::ranges::all_of(diagnosis.tests, &SeriesTest::explained);
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    diagnosis.forces.push_back(missing_force(job, result, r));
  return diagnosis;
}

std::vector<SuspectedEffect> suspected_effects(const Job& job, const FitResult& result,
                                               const RunContext& context) {
  const ScoreTest test =
      score_test(job, values_of(result), score_gains(job).front(), false, context);
  constexpr std::size_t kSuspects = 5;
  constexpr double kMinFraction = 0.02;
  std::vector<SuspectedEffect> suspects;
  for (const Score& score : test.scores) {
    const Candidate& candidate = test.candidates[score.candidate];
    const double fraction = score.gain / test.sum_of_squares;
    if (suspects.size() == kSuspects || !(fraction >= kMinFraction)) break;
    const bool known = std::ranges::any_of(
        suspects, [&](const SuspectedEffect& s) { return same_effect(s.candidate, candidate); });
    if (!known) suspects.push_back({candidate, score.shapes, score.strengths, fraction});
  }
  return suspects;
}

}  // namespace axisfit
