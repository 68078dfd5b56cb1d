#include "fit/selection/diagnosis.h"

#include <algorithm>

#include "fit/selection/score.h"

namespace axisfit {

Diagnosis diagnose(const Job& job, const FitResult& result) {
  Diagnosis diagnosis;
  diagnosis.tests = test_residuals(job, result);
  diagnosis.explained =
      !diagnosis.tests.empty() && std::ranges::all_of(diagnosis.tests, &SeriesTest::explained);
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    diagnosis.forces.push_back(missing_force(job, result, r));
  if (diagnosis.explained || !result.usable) return diagnosis;
  const ScoreTest test = score_test(job, values_of(result), score_rates(job).front());
  constexpr std::size_t kSuspects = 5;
  constexpr double kLeastShare = 0.02;
  for (const Score& score : test.scores) {
    const Candidate& candidate = test.candidates[score.candidate];
    const double share = score.gain / test.sum_of_squares;
    if (diagnosis.suspects.size() == kSuspects || !(share >= kLeastShare)) break;
    const bool known = std::ranges::any_of(
        diagnosis.suspects, [&](const Suspect& s) { return same_effect(s.candidate, candidate); });
    if (!known) diagnosis.suspects.push_back({candidate, score.shapes, score.strengths, share});
  }
  return diagnosis;
}

}  // namespace axisfit
