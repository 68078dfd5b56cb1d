#include "fit/selection/shortlist.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

// Below a gain of six it is chance; what gains more, and little, is heard where there is room.
TEST(Shortlist, HasAllThatGainMoreThanSix) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = 0.12;
  const Job job = two_recordings(truth, slide(), {"M", "B_a"});
  const std::vector<double> values{20.0, 30.0};
  std::set<std::string> expected;
  int little = 0;
  for (const double rate : score_gains(job)) {
    const ScoreTest test = score_test(job, values, rate);
    ASSERT_TRUE(test.usable);
    for (const Score& score : test.scores) {
      if (score.gain < 6.0) continue;
      expected.insert(test.candidates[score.candidate].name);
      little += score.gain < 15.0 ? 1 : 0;
    }
  }
  EXPECT_GT(little, 0);
  std::set<std::string> found;
  for (const ShortlistEntry& promise :
       shortlist(job, values, score_gains(job), false, 1000).entries) {
    found.insert(promise.candidate.name);
    EXPECT_GE(promise.score.gain, 6.0) << promise.candidate.name;
  }
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace axisfit
