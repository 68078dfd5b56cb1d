#include "fit/search/score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "fit/criterion/gains.h"
#include "fit/search/select_effects.h"
#include "tests/fit/search/hidden_effects.h"

namespace axisfit {
namespace {

/// Of every hypothesis the best setting.
std::vector<Scored> best_settings(const ScoreTest& test) {
  std::vector<Scored> list;
  for (const Scored& score : test.scores) {
    if (std::ranges::find(list, score.hypothesis, &Scored::hypothesis) == list.end())
      list.push_back(score);
  }
  return list;
}

ScoreTest score(const Job& job) {
  const FitResult fit = estimate(job);
  EXPECT_TRUE(fit.is_usable()) << fit.message;
  return score_test(job, values_of(fit), search_gain(job));
}

class ScoreOf : public testing::TestWithParam<HiddenEffect> {};

TEST_P(ScoreOf, TheTrueEffectIsAmongTheTwoBest) {
  const HiddenEffect& secret = GetParam();
  const ScoreTest test = score(secret.job());
  ASSERT_TRUE(test.usable);
  const auto list = best_settings(test);
  ASSERT_GE(list.size(), 2u);
  std::size_t place = 0;
  while (place < list.size() && list[place].hypothesis->name != secret.name) ++place;
  ASSERT_LT(place, 2u) << secret.name << " behind " << list[0].hypothesis->name;
  const Scored& score = list[place];
  std::cout << "explains " << score.gain << " of " << test.sum_of_squares;
  double wanted = 0.0, found = 0.0;
  for (std::size_t k = 0; k < secret.strengths.size(); ++k) {
    const double neutral = secret.neutral(k);
    wanted = std::hypot(wanted, secret.strengths[k].second - neutral);
    found = std::hypot(found, score.own.strengths[k] - neutral);
  }
  std::cout << ", strength " << found << " of " << wanted << "\n";
  if (!secret.linear) return;
  EXPECT_NEAR(found, wanted, 0.3 * wanted);
}

INSTANTIATE_TEST_SUITE_P(EverySlot, ScoreOf, testing::ValuesIn(hidden_effects()),
                         [](const auto& one) { return one.param.label(); });

TEST(CloseGain, IsTheHighestAtWhichTheResidualStandsOutOfTheNoise) {
  Model<double> truth = slide();
  for (const auto& [level, part] : {std::pair{2000.0, 1.0}, {150.0, 10.0}}) {
    add_effect<CoulombFriction>(truth).F_c = level;
    const Job job = two_recordings(truth, slide(), {"M", "B_a"}, 60.0, {Signal::velocity});
    const auto gain = close_gain(job, {20.0, 30.0});
    ASSERT_TRUE(gain) << level;
    EXPECT_DOUBLE_EQ(*gain, highest_gain(job) / part) << level;
  }
  add_effect<CoulombFriction>(truth).F_c = 1.0;
  EXPECT_FALSE(close_gain(two_recordings(truth, slide(), {"M", "B_a"}), {20.0, 30.0}));
}

TEST(CloseGain, IsNothingWhereTheJobGivesOne) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = 200.0;
  Job job = two_recordings(truth, slide(), {"M", "B_a"}, 60.0, {Signal::velocity});
  ASSERT_TRUE(close_gain(job, {20.0, 30.0}));
  job.options.criterion = Tracking{30.0};
  EXPECT_FALSE(close_gain(job, {20.0, 30.0}));
}

// Of n independent chi-square variables with one degree of freedom the largest is about 2 log n.
TEST(ScoreTestOf, ACleanRecordingIsChance) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Job job = two_recordings(slide(), slide(), {"M", "B_a"}, 6.0,
                             {Signal::velocity, Signal::acceleration}, seed);
    const ScoreTest test = score(job);
    ASSERT_TRUE(test.usable);
    const auto list = best_settings(test);
    std::cout << list[0].hypothesis->name << " " << list[0].gain << " of " << test.scores.size()
              << "\n";
    EXPECT_LT(list[0].gain, 25.0);
    const double n = static_cast<double>(2 * job.recordings[0].times.size());
    EXPECT_NEAR(test.sum_of_squares, n, 0.15 * n);
  }
}

TEST(ScoreTestOf, APeriodicForceFindsItsPeriod) {
  for (const double period : {0.02, 0.05, 0.13}) {
    Model<double> truth = slide();
    auto& force = add_effect<PeriodicForce>(truth);
    force.F_s1 = 4.0;
    force.F_c1 = 3.0;
    force.period = period;
    const ScoreTest test = score(two_recordings(truth, slide(), {"M", "B_a"}));
    ASSERT_TRUE(test.usable);
    const auto list = best_settings(test);
    ASSERT_EQ(list[0].hypothesis->name, "periodic_force") << period;
    std::cout << "period " << period << " found " << list[0].own.shapes[0] << " amplitude "
              << std::hypot(list[0].own.strengths[0], list[0].own.strengths[1]) << "\n";
    EXPECT_NEAR(list[0].own.shapes[0], period, 0.02 * period);
  }
}

TEST(ScoreTestOf, TheScoresDoNotDependOnTheNumberOfThreads) {
  Job job = hidden_effects().front().job();
  const std::vector<double> values{20.0, 30.0};
  job.options.threads = 1;
  const ScoreTest one = score_test(job, values, 30.0);
  job.options.threads = 2;
  const ScoreTest two = score_test(job, values, 30.0);
  ASSERT_EQ(one.scores.size(), two.scores.size());
  for (std::size_t i = 0; i < one.scores.size(); ++i) {
    EXPECT_EQ(one.scores[i].hypothesis->name, two.scores[i].hypothesis->name);
    EXPECT_EQ(one.scores[i].gain, two.scores[i].gain);
    EXPECT_EQ(one.scores[i].own.strengths, two.scores[i].own.strengths);
  }
}

// What the free parameters do already is no effect.
TEST(ScoreTestOf, ADuplicateOfAFreeParameterGainsNothing) {
  Model<double> truth = slide();
  add_effect<AddedMass>(truth).dM = 1.0;
  const ScoreTest test = score(two_recordings(truth, slide(), {"M", "B_a"}));
  const auto added = std::ranges::find_if(
      test.scores, [&](const Scored& one) { return one.hypothesis->name == "added_mass"; });
  ASSERT_NE(added, test.scores.end());
  EXPECT_EQ(added->gain, 0.0);
}

TEST(ScoreTestOf, AModelThatCannotBeSimulatedIsNotUsable) {
  Job job = two_recordings(slide(), slide(), {"B_a"});
  job.model.axis.M = std::nan("");
  EXPECT_FALSE(score_test(job, {30.0}, 30.0).usable);
}

}  // namespace
}  // namespace axisfit
