#include "fit/design/run_time_estimate.h"

#include <gtest/gtest.h>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// Simulated in no time.
Job short_job() {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  job.recordings = {recorded(slide(), fit_motion(), 0.1, 1)};
  return job;
}

/// Evaluations of a fit that makes further attempts, over those of one that does not: whatever
/// the machine does besides.
double further_attempts(const Job& job) {
  const RunTimeEstimate t = estimate_run_time(job);
  return (t.unexplained - t.explained) / t.evaluation;
}

TEST(RunTimeEstimate, IsTheLongerTheLessTheModelExplains) {
  for (const bool continued : {true, false}) {
    Job job = short_job();
    if (!continued) job.options.continuation.reset();
    const RunTimeEstimate t = estimate_run_time(job);
    EXPECT_GT(t.evaluation, 0.0);
    EXPECT_GT(t.explained, t.evaluation);
    EXPECT_GT(t.unexplained, t.explained);
    EXPECT_GT(t.nothing_missing, t.explained);
    EXPECT_GT(t.one_effect, t.unexplained);
    EXPECT_GT(t.one_effect, t.nothing_missing);
    EXPECT_GT(t.no_effect, t.one_effect);
  }
}

TEST(RunTimeEstimate, IsInProportionToTheStartsOfEachThread) {
  Job job = short_job();
  const double once = further_attempts(job);
  job.options.starts = 6;
  EXPECT_NEAR(further_attempts(job), 6.0 * once, 1e-6 * once);
  job.options.threads = 3;
  EXPECT_NEAR(further_attempts(job), 2.0 * once, 1e-6 * once);
  job.options.threads = 12;  // more than there are starts
  EXPECT_NEAR(further_attempts(job), once, 1e-6 * once);
}

TEST(RunTimeEstimate, IsShorterWithoutAContinuation) {
  Job job = short_job();
  const double with = further_attempts(job);
  job.options.continuation.reset();
  EXPECT_LT(further_attempts(job), with);
}

}  // namespace
}  // namespace axisfit
