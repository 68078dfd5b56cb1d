#include "fit/estimate/horizon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fit/criterion/gains.h"
#include "tests/fit/wandering.h"

namespace axisfit {
namespace {

std::vector<Criterion> tried(const HorizonChoice& choice) {
  std::vector<Criterion> criteria;
  for (const HorizonTrial& trial : choice.trials) criteria.push_back(trial.criterion);
  return criteria;
}

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
  const double stretch = choice.longest, interval = 1.0 / highest_gain(job);
  std::vector<Criterion> expected{Tracking{highest_gain(job)}};
  for (const double share : {0.01, 0.03, 0.1, 0.3, 1.0})
    if (share * stretch >= 30.0 * interval) expected.push_back(Windows{share * stretch});
  ASSERT_GE(expected.size(), 3u);
  expected.push_back(FreeRun{});
  EXPECT_EQ(tried(choice), expected);
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
  for (Recording& r : job.recordings)
    r.overrides.emplace_back(find_quantity("B_a")->index, std::nan(""));
  job.free.pop_back();
  EXPECT_THROW(choose_horizon(job), NoHorizon);
}

}  // namespace
}  // namespace axisfit
