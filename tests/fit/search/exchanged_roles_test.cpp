#include "fit/search/exchanged_roles.h"

#include <gtest/gtest.h>

#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

TEST(ExchangedRoles, FitWhatWasToValidate) {
  const Job job = hidden_effect_named("coulomb_friction").job();
  const auto found = search_with_exchanged_roles(job);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->baseline.recordings[0].role, Role::validate);
  EXPECT_EQ(found->baseline.recordings[1].role, Role::fit);
  EXPECT_EQ(accepted(found->selection), std::set<std::string>{"coulomb_friction"});
  EXPECT_EQ(values_of(found->first), values_of(found->selection.models.front().fit));
}

TEST(ExchangedRoles, AreNoneWhereRecordingsHaveDifferentSignals) {
  Job job = hidden_effect_named("coulomb_friction").job();
  job.recordings[1].measurements.pop_back();
  EXPECT_FALSE(search_with_exchanged_roles(job));
}

TEST(ExchangedRoles, AreNoneWhereNothingValidates) {
  Job job = hidden_effect_named("coulomb_friction").job();
  job.recordings.pop_back();
  EXPECT_FALSE(search_with_exchanged_roles(job));
}

TEST(ExchangedRoles, AreNoneWhereNothingIsFound) {
  EXPECT_FALSE(search_with_exchanged_roles(two_recordings(slide(), slide(), {"M", "B_a"})));
}

TEST(ExchangedRoles, StopWithoutAResult) {
  StopFlag stop;
  stop.set();
  EXPECT_THROW(search_with_exchanged_roles(hidden_effect_named("coulomb_friction").job(), {&stop}),
               Interrupted);
}

// There is time left to judge what the search before it found.
TEST(ExchangedRoles, SayThatTheirSearchWasCutShort) {
  const StopFlag stop;
  StopFlag search_over(&stop);
  search_over.set();
  const auto found = search_with_exchanged_roles(hidden_effect_named("coulomb_friction").job(),
                                                 {.stop = &stop, .end_search = &search_over});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->selection.cut_short);
}

}  // namespace
}  // namespace axisfit
