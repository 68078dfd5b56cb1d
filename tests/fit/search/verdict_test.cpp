#include "fit/search/verdict.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

using enum SelectionVerdict::Kind;

TEST(KindOf, NothingIsMissingWhereOnlyNoiseIsLeft) {
  EffectSelection selection;
  EXPECT_EQ(kind_of(selection, true), nothing_missing);
  selection.verdict.small = {"coulomb_friction"};
  EXPECT_EQ(kind_of(selection, true), hardly_anything);
}

TEST(KindOf, AcceptedEffectsComeBeforeAllElse) {
  EffectSelection selection;
  selection.verdict.accepted = {"coulomb_friction"};
  selection.interrupted = true;
  selection.verdict.undecided = {"stroke_spring", "pendulum_gravity"};
  EXPECT_EQ(kind_of(selection, false), effects_accepted);
  EXPECT_EQ(kind_of(selection, true), effects_accepted);
}

TEST(KindOf, AStoppedSearchProvesNothing) {
  EffectSelection selection;
  selection.interrupted = true;
  EXPECT_EQ(kind_of(selection, false), stopped);
}

TEST(KindOf, UndecidedEffectsExplainWithoutBeingAccepted) {
  EffectSelection selection;
  selection.verdict.undecided = {"stroke_spring", "pendulum_gravity"};
  EXPECT_EQ(kind_of(selection, true), undecided);
  EXPECT_EQ(kind_of(selection, false), undecided);
}

TEST(KindOf, SomethingIsMissingWhereNothingPasses) { EXPECT_EQ(kind_of({}, false), none_passes); }

}  // namespace
}  // namespace axisfit
