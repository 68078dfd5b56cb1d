#include "fit/estimate/recipes.h"

#include <gtest/gtest.h>

#include "fit/estimate/estimate.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// A job whose options are none of the defaults.
Job thorough() {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"}, 6.0, {Signal::velocity});
  job.options.criterion = Windows{0.4};
  job.options.starts = 7;
  job.options.attempts = 6;
  job.options.max_iterations = 40;
  return job;
}

TEST(Recipes, KeepTheCriterion) {
  const Job job = thorough();
  for (const FitOptions& options :
       {recipe::once(job.options), recipe::polish(job.options), recipe::rough(job.options),
        recipe::quick(job.options), recipe::coarse(job.options), recipe::refit(job, 25),
        recipe::final_fit(job)})
    EXPECT_EQ(options.criterion, job.options.criterion);
}

TEST(Recipes, BeginOnceWhereTheMinimumIsNear) {
  const Job job = thorough();
  for (const FitOptions& options : {recipe::once(job.options), recipe::quick(job.options),
                                    recipe::refit(job, 25), recipe::final_fit(job)}) {
    EXPECT_EQ(options.starts, 1);
    EXPECT_EQ(options.attempts, 1);
    EXPECT_TRUE(options.is_continued());
  }
  EXPECT_EQ(recipe::rough(job.options).starts, 7);
}

TEST(Recipes, ContinueASearchFromTheGainsOfTheScore) {
  Job job = thorough();
  EXPECT_EQ(recipe::refit(job, 25).continuation->start_gain, score_gains(job).front());
  EXPECT_EQ(recipe::final_fit(job).continuation->start_gain, score_gains(job).back());
  job.options.continuation.reset();
  EXPECT_FALSE(recipe::refit(job, 25).continuation);
  EXPECT_FALSE(recipe::final_fit(job).continuation);
}

TEST(Recipes, AreNoLongerThanTheJobAllows) {
  Job job = thorough();
  EXPECT_EQ(recipe::refit(job, 25).max_iterations, 25);
  EXPECT_EQ(recipe::refit(job, 100).max_iterations, 40);
}

// It would leave the minimum for the one that tracking leads to.
TEST(Recipes, PolishAMinimumWithoutTracking) {
  Job job = thorough();
  job.options.criterion = FreeRun{};
  job.options = recipe::polish(job.options);
  const FitResult fit = estimate(job);
  EXPECT_EQ(fit.starts.size(), 1u);
  ASSERT_EQ(fit.stages.size(), 1u);
  EXPECT_EQ(fit.stages[0].observer_gain, 0.0);
}

TEST(Recipes, AreQuickWithinTheStandardErrors) {
  Job job = thorough();
  job.options.criterion = FreeRun{};
  job.options.starts = 1;
  const FitResult exact = estimate(job);
  job.options = recipe::quick(job.options);
  const FitResult quick = estimate(job);
  for (std::size_t i = 0; i < job.free.size(); ++i)
    EXPECT_NEAR(quick.parameters[i].value, exact.parameters[i].value,
                0.1 * exact.parameters[i].uncertainty.standard_error);
}

}  // namespace
}  // namespace axisfit
