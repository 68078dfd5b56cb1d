#include "fit/search/suspects.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

TEST(SuspectedEffects, BeginWithTheCauseAndNameEachOnce) {
  const Job job = hidden_effect_named("coulomb_friction").job();
  const std::vector<Scored> suspects = suspected_effects(job, estimate(job));
  ASSERT_FALSE(suspects.empty());
  EXPECT_EQ(suspects.front().hypothesis->name, "coulomb_friction");
  EXPECT_NEAR(suspects.front().own.strengths[0], 5.0, 1.5);
  std::set<std::string> names;
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    EXPECT_TRUE(names.insert(suspects[i].hypothesis->name).second);
    EXPECT_GE(suspects[i].fraction, 0.02);
    EXPECT_LE(suspects[i].fraction, suspects[i > 0 ? i - 1 : 0].fraction);
  }
}

TEST(SuspectedEffects, AreNoMoreThanAskedFor) {
  const Job job = hidden_effect_named("coulomb_friction").job();
  SearchContext few;
  few.options.scoring.suspects = 1;
  EXPECT_EQ(suspected_effects(job, estimate(job), few).size(), 1u);
  SearchContext none;
  none.options.scoring.least_fraction = 1.0;
  EXPECT_TRUE(suspected_effects(job, estimate(job), none).empty());
}

TEST(LikelyCause, ExplainsAThird) {
  std::vector<Scored> suspects;
  EXPECT_EQ(likely_cause(suspects), nullptr);
  suspects.resize(2);
  suspects[0].fraction = 0.33;
  EXPECT_EQ(likely_cause(suspects), nullptr);
  suspects[0].fraction = 0.34;
  EXPECT_EQ(likely_cause(suspects), &suspects[0]);
}

TEST(SuspectedEffects, AreNoneOfACleanRecording) {
  const Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  EXPECT_TRUE(suspected_effects(job, estimate(job)).empty());
}

}  // namespace
}  // namespace axisfit
