#include "fit/estimate/horizon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <span>
#include <string>

#include "fit/criterion/gains.h"
#include "tests/fit/wandering.h"

namespace axisfit {
namespace {

TEST(ChooseHorizon, IsShortWhereAForceWandersAndLongElsewhere) {
  const Job wandering = wandering_slide(3.0);
  const HorizonChoice choice = choose_horizon(wandering);
  EXPECT_EQ(choice.stretches, 4);
  EXPECT_NEAR(choice.longest, 4.0, 1e-9);
  const HorizonTrial& chosen = choice.best();
  EXPECT_FALSE(std::holds_alternative<FreeRun>(chosen.criterion));
  EXPECT_LT(window_length(chosen.criterion), 1.0);
  EXPECT_LT(chosen.error, 0.9 * choice.trials.back().error);

  const HorizonChoice other = choose_horizon(wandering_slide(0.0));
  std::cout << "one step ahead, error per that of the whole run: "
            << other.trials.front().error / other.trials.back().error << "\n";
  EXPECT_LT(other.trials.back().error, 1.05 * other.best().error);
  EXPECT_GT(other.trials.front().error, 2.0 * other.trials.back().error);
}

/// Two short recordings of a slide, of which everything is known.
Job exact_slide() {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"}, 6.0, {Signal::velocity});
  job.recordings[1].role = Role::fit;
  job.options.threads = 1;
  return job;
}

TEST(ChooseHorizon, TriesOneStepAheadThenWindowsThenTheWhole) {
  const Job job = exact_slide();
  const HorizonChoice choice = choose_horizon(job);
  EXPECT_EQ(choice.stretches, 4);
  EXPECT_NEAR(choice.longest, 0.6, 1e-9);
  EXPECT_EQ(choice.trials.front().criterion, Criterion(Tracking{highest_gain(job)}));
  EXPECT_EQ(choice.trials.back().criterion, Criterion(FreeRun{}));
  // Of 30 samples at least, up to a whole stretch.
  const auto windows = std::span(choice.trials).subspan(1, choice.trials.size() - 2);
  ASSERT_GE(windows.size(), 2u);
  EXPECT_GE(window_length(windows.front().criterion), 30.0 / highest_gain(job));
  for (std::size_t i = 1; i < windows.size(); ++i)
    EXPECT_GT(window_length(windows[i].criterion), window_length(windows[i - 1].criterion));
  EXPECT_EQ(windows.back().criterion, Criterion(Windows{choice.longest}));
  for (const HorizonTrial& trial : choice.trials) EXPECT_GE(trial.error, choice.best().error);
  // Where nothing is missing all but noise is predicted.
  EXPECT_LT(choice.best().error, 0.02);
}

// One step ahead of a late signal the simulation is late itself.
TEST(ChooseHorizon, DoesNotTrackALateSignal) {
  Job job = exact_slide();
  job.free.push_back(free_parameter("velocity.delay", 1e-3));
  const HorizonChoice choice = choose_horizon(job);
  for (const HorizonTrial& trial : choice.trials) EXPECT_FALSE(tracks(trial.criterion));
}

TEST(ChooseHorizon, RefusesAModelThatCannotBeSimulated) {
  Job job = exact_slide();
  for (Recording& r : job.recordings) r.overrides.emplace_back(quantity_index("B_a"), std::nan(""));
  job.free.pop_back();
  try {
    choose_horizon(job);
    FAIL() << "chose a horizon";
  } catch (const NoHorizon& problem) {
    EXPECT_TRUE(std::string(problem.what())
                    .starts_with("horizon: auto: the model cannot be simulated at any start: "))
        << problem.what();
  }
}

}  // namespace
}  // namespace axisfit
