#include "fit/search/rivals.h"

#include <gtest/gtest.h>

#include "tests/fit/search/hypotheses.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

const SearchContext kContext;

std::shared_ptr<const Hypothesis> hypothesis(const Job& job, const char* name) {
  const std::vector<Hypothesis> all = catalogue(job, scales());
  return std::make_shared<const Hypothesis>(*find(all, name));
}

/// A search that accepted one hypothesis, with another as its rival.
SearchState accepted_with_rival(const Job& job, const char* chosen, HypothesisValues own,
                                const char* rival) {
  SearchState state{ModelChain({"", job, estimate(job)}, kContext)};
  const auto accepted = hypothesis(job, chosen);
  Tried tried =
      try_hypothesis(job, {accepted, std::move(own), values_of(state.current().fit)}, kContext);
  state.outcomes.record(tried, &tried, 1);
  state.chain.append({*accepted, {Scored{hypothesis(job, rival)}}}, std::move(tried.job),
                     std::move(tried.fit));
  return state;
}

/// Scores of the free run, beside all that is accepted.
Shortlist scores_of(const SearchState& state) {
  const FittedModel& present = state.current();
  return shortlist(present.job, values_of(present.fit), {0.0}, false, kContext);
}

TEST(BetterRival, IsTheTrueEffectInPlaceOfAnother) {
  SearchState state = accepted_with_rival(hidden_effect_named("coulomb_friction").job(),
                                          "stroke_spring", {{1.0}, {}}, "coulomb_friction");
  const auto found = better_rival(state, scores_of(state), kContext);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->place, 0u);
  EXPECT_EQ(found->tried.hypothesis.name, "coulomb_friction");
  EXPECT_FALSE(found->tried.rejection);
  EXPECT_NEAR(found->tried.fit.parameters.back().value, 5.0, 0.2);
}

TEST(BetterRival, IsNoneWhereTheTrueEffectWasChosen) {
  SearchState state = accepted_with_rival(hidden_effect_named("coulomb_friction").job(),
                                          "coulomb_friction", {{4.0}, {}}, "stroke_spring");
  EXPECT_FALSE(better_rival(state, scores_of(state), kContext));
}

TEST(BetterRival, IsNotLookedForWhereItPromisesNothing) {
  SearchState state = accepted_with_rival(hidden_effect_named("coulomb_friction").job(),
                                          "stroke_spring", {{1.0}, {}}, "coulomb_friction");
  Shortlist scores = scores_of(state);
  for (Shortlist::Promise& promise : scores.promises) promise.gain = 0.0;
  EXPECT_FALSE(better_rival(state, scores, kContext));
}

// Of a slide with one free parameter, twice the force does what half the mass does.
TEST(EqualRivals, AreWhatExplainsAsMuch) {
  const HiddenEffect mass = hidden_effect_named("added_mass");
  SearchState state =
      accepted_with_rival(mass.job(), "added_mass", {{0.4}, {}}, "coulomb_friction");
  EXPECT_TRUE(equal_rivals(state, 2, kContext).empty());
  state.chain.accepted()[0].rivals = {
      Scored{hypothesis(state.chain.declared().job, mass.twin.c_str())}};
  const auto equals = equal_rivals(state, 2, kContext);
  ASSERT_EQ(equals.size(), 1u);
  EXPECT_EQ(equals[0].place, 0u);
  EXPECT_EQ(equals[0].tried.hypothesis.name, mass.twin);
  const Outcome* outcome = state.outcomes.find(equals[0].tried.hypothesis);
  ASSERT_NE(outcome, nullptr);
  EXPECT_EQ(outcome->round, 2);
}

// Dahl friction of no length is dry friction: it is no rival of its own.
TEST(EqualRivals, AreNotWhatHasBecomeASimplerLaw) {
  SearchState state =
      accepted_with_rival(hidden_effect_named("coulomb_friction").job(), "stribeck_friction",
                          {{5.0}, {1.0, 1.0}}, "dahl_friction");
  Scored& dahl = state.chain.accepted()[0].rivals.front();
  dahl.own = {{5.0}, {1e-6}};
  const Job others = state.chain.job_with_accepted(state.chain.declared().job, 0);
  dahl.others = initial_values(others);
  const Tried refit = try_hypothesis(others, dahl, kContext);
  ASSERT_TRUE(explains({"", refit.job, refit.fit}));
  ASSERT_TRUE(rejection_as_simpler(refit.job, refit.fit, refit.hypothesis));
  SearchContext context;
  context.options.acceptance.odds = 1e300;  // all do about as well
  EXPECT_TRUE(equal_rivals(state, 2, context).empty());
}

TEST(AreDelays, NeedsTwoTimesThatAreNoConstants) {
  const Job job = two_recordings(slide(), slide(), {"M"}, 6.0, {Signal::velocity});
  const auto dead_time = hypothesis(job, "dead_time"), delay = hypothesis(job, "velocity.delay"),
             gain = hypothesis(job, "velocity.gain");
  EXPECT_TRUE(are_delays(*dead_time, *delay));
  EXPECT_FALSE(are_delays(*dead_time, *gain));
  Hypothesis constant = *delay;
  constant.kind = HypothesisKind::constant;
  EXPECT_FALSE(are_delays(*dead_time, constant));
}

}  // namespace
}  // namespace axisfit
