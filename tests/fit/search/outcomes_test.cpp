#include "fit/search/outcomes.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

Hypothesis hypothesis(const char* name, std::size_t strength) {
  Hypothesis h;
  h.name = name;
  h.strengths = {strength};
  return h;
}

/// Refitted with one parameter of its own, behind one of the axis.
Tried tried(const Hypothesis& h, double value) {
  Tried t;
  t.hypothesis = h;
  t.job.free.resize(2);
  t.fit.parameters.resize(2);
  t.fit.parameters[1].value = value;
  return t;
}

const Hypothesis kFriction = hypothesis("friction", 1), kSpring = hypothesis("spring", 2);

TEST(DecisionOn, IsThatOfTheReason) {
  for (const Reason r : {Reason::explains_best, Reason::replicates, Reason::shown_by_blocks,
                         Reason::explains_beside})
    EXPECT_EQ(decision_on(r), Decision::accepted);
  EXPECT_EQ(decision_on(Reason::explains_equally), Decision::undecided);
  for (const Reason r : {Reason::failed_test, Reason::explains_less, Reason::replaced,
                         Reason::is_equal_delay, Reason::not_needed, Reason::falls_with})
    EXPECT_EQ(decision_on(r), Decision::rejected);
}

TEST(Outcomes, TellWhyTheBestOfARoundIsAccepted) {
  Tried best = tried(kFriction, 5.0);
  Outcomes outcomes;
  outcomes.record(best, &best, 1);
  EXPECT_EQ(outcomes.list()[0].reason, Reason::explains_best);
  EXPECT_TRUE(outcomes.list()[0].in_model);
  ASSERT_EQ(outcomes.list()[0].parameters.size(), 1u);  // its own
  EXPECT_EQ(outcomes.list()[0].parameters[0].value, 5.0);
  best.on_blocks = true;
  outcomes.record(best, &best, 1);
  EXPECT_EQ(outcomes.list()[0].reason, Reason::shown_by_blocks);
  best.replication = Replication{};
  outcomes.record(best, &best, 1);
  EXPECT_EQ(outcomes.list()[0].reason, Reason::replicates);
}

TEST(Outcomes, TellWhatTheOthersOfARoundLack) {
  const Tried best = tried(kFriction, 5.0);
  Tried other = tried(kSpring, 20.0);
  Outcomes outcomes;
  outcomes.record(other, &best, 1);
  EXPECT_EQ(outcomes.list()[0].reason, Reason::explains_less);
  EXPECT_EQ(outcomes.list()[0].other, "friction");
  EXPECT_FALSE(outcomes.list()[0].in_model);
  other.rejection = Rejection{.test = Rejection::Test::validation, .found = 0.3};
  outcomes.record(other, &best, 1);
  EXPECT_EQ(outcomes.list()[0].reason, Reason::failed_test);
  EXPECT_EQ(outcomes.list()[0].rejection, other.rejection);
}

TEST(Outcomes, KeepTheLastOfEachHypothesis) {
  const Tried first = tried(kFriction, 5.0), again = tried(kFriction, 6.0);
  Outcomes outcomes;
  outcomes.record(first, &first, 1);
  outcomes.record(again, &again, 3);
  ASSERT_EQ(outcomes.list().size(), 1u);
  EXPECT_EQ(outcomes.list()[0].round, 3);
  EXPECT_EQ(outcomes.list()[0].parameters[0].value, 6.0);
  EXPECT_EQ(outcomes.find(kSpring), nullptr);
}

TEST(Outcomes, RejectWhatTheModelLosesAndForgetNoOther) {
  const Tried best = tried(kFriction, 5.0);
  Outcomes outcomes;
  outcomes.record(best, &best, 1);
  outcomes.reject(kSpring, Reason::not_needed);  // was never refitted
  EXPECT_EQ(outcomes.list().size(), 1u);
  outcomes.reject(kFriction, Reason::replaced, "spring");
  EXPECT_EQ(outcomes.list()[0].decision(), Decision::rejected);
  EXPECT_EQ(outcomes.list()[0].other, "spring");
  EXPECT_FALSE(outcomes.list()[0].in_model);
  outcomes.fail(kFriction, {.test = Rejection::Test::bound});
  EXPECT_EQ(outcomes.list()[0].reason, Reason::failed_test);
  EXPECT_EQ(outcomes.list()[0].rejection->test, Rejection::Test::bound);
  EXPECT_EQ(outcomes.list()[0].other, "");
}

/// Of two that explain as much as each other, the friction in the model.
Outcomes of_equals() {
  const Tried friction = tried(kFriction, 5.0), spring = tried(kSpring, 20.0);
  Outcomes outcomes;
  outcomes.record(friction, &friction, 1);
  outcomes.record(spring, &spring, 2);
  outcomes.leave_undecided(kFriction, kSpring);
  return outcomes;
}

TEST(Outcomes, LeaveOneOfTwoEqualsInTheModel) {
  Outcomes outcomes = of_equals();
  for (const Outcome& o : outcomes.list()) EXPECT_EQ(o.decision(), Decision::undecided);
  EXPECT_TRUE(outcomes.find(kFriction)->in_model);
  EXPECT_FALSE(outcomes.find(kSpring)->in_model);
  EXPECT_EQ(outcomes.find(kFriction)->other, "spring");
  EXPECT_EQ(outcomes.find(kSpring)->other, "friction");
}

TEST(Outcomes, RejectTheEqualsOfWhatTheModelLoses) {
  Outcomes outcomes = of_equals();
  outcomes.fail(kFriction, {.test = Rejection::Test::strength});
  EXPECT_EQ(outcomes.find(kFriction)->reason, Reason::failed_test);
  EXPECT_EQ(outcomes.find(kSpring)->decision(), Decision::rejected);
  EXPECT_EQ(outcomes.find(kSpring)->reason, Reason::falls_with);
  EXPECT_EQ(outcomes.find(kSpring)->other, "friction");
}

}  // namespace
}  // namespace axisfit
