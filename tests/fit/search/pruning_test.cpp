#include "fit/search/pruning.h"

#include <gtest/gtest.h>

#include "tests/fit/search/hypotheses.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

const SearchContext kContext;

/// A search that accepted these hypotheses, one after another, started from these strengths.
SearchState accepted_in(const Job& job,
                        const std::vector<std::pair<const char*, HypothesisValues>>& effects) {
  SearchState state{ModelChain({"", job, estimate(job)}, kContext)};
  int round = 0;
  for (const auto& [name, own] : effects) {
    const FittedModel& now = state.current();
    const std::vector<Hypothesis> all = catalogue(now.job, scales());
    const auto hypothesis = std::make_shared<const Hypothesis>(*find(all, name));
    Tried tried = try_hypothesis(now.job, {hypothesis, own, values_of(now.fit)});
    state.outcomes.record(tried, &tried, ++round);
    state.chain.append({*hypothesis}, std::move(tried.job), std::move(tried.fit));
  }
  return state;
}

std::vector<std::string> names_in(const SearchState& state) {
  std::vector<std::string> names;
  for (const Accepted& a : state.accepted()) names.push_back(a.hypothesis.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(EliminateBackward, DropsWhatTheModelDoesNotNeed) {
  SearchState state =
      accepted_in(hidden_effect_named("coulomb_friction").job(),
                  {{"coulomb_friction", {{4.0}, {}}}, {"stroke_spring", {{1.0}, {}}}});
  eliminate_backward(state, kContext);
  EXPECT_EQ(names_in(state), Names{"coulomb_friction"});
  const Hypothesis spring = state.outcomes.list()[1].hypothesis;
  EXPECT_EQ(state.outcomes.find(spring)->reason, Reason::not_needed);
  EXPECT_TRUE(state.outcomes.list()[0].in_model);
  EXPECT_EQ(state.current().job.free.size(), 3u);
}

TEST(NameAsFirst, GivesASecondElementWithoutAFirstItsName) {
  const HypothesisValues small{{0.1, 0.1}, {0.2}}, found{{4.0, 3.0}, {0.05}};
  SearchState state = accepted_in(hidden_effect_named("periodic_force").job(),
                                  {{"periodic_force", small}, {"second_periodic_force", found}});
  name_as_first(state, kContext);
  EXPECT_EQ(names_in(state), (Names{"periodic_force", "second_periodic_force"}));
  state.outcomes.reject(state.accepted()[0].hypothesis, Reason::not_needed);
  state.take_out(0, state.chain.without(0));
  ASSERT_EQ(names_in(state), Names{"second_periodic_force"});
  name_as_first(state, kContext);
  EXPECT_EQ(names_in(state), Names{"periodic_force"});
  ASSERT_EQ(state.outcomes.list().size(), 1u);
  const Outcome& outcome = state.outcomes.list()[0];
  EXPECT_EQ(outcome.hypothesis.name, "periodic_force");
  EXPECT_EQ(outcome.reason, Reason::explains_best);
  const Job& job = state.current().job;
  EXPECT_EQ(outcome.parameters.back().id, id_of("periodic_force.period"));
  EXPECT_NEAR(outcome.parameters.back().value, 0.05, 1e-3);
  EXPECT_EQ(job.free.size(), 5u);
}

// Neither the data nor what was accepted before leave a friction anything to do.
TEST(DropUndetermined, TakesOutWhatTheFinalFitLeavesOpen) {
  SearchState state =
      accepted_in(hidden_effect_named("coulomb_friction").job(),
                  {{"coulomb_friction", {{4.0}, {}}}, {"constant_force", {{1.0}, {}}}});
  EXPECT_TRUE(drop_undetermined(state, state.current(), kContext));
  EXPECT_EQ(names_in(state), Names{"coulomb_friction"});
  EXPECT_EQ(state.outcomes.list()[1].rejection->test, Rejection::Test::strength);
  EXPECT_FALSE(drop_undetermined(state, state.current(), kContext));
  EXPECT_EQ(names_in(state), Names{"coulomb_friction"});
}

TEST(DropUndetermined, TakesOutWhatABoundHolds) {
  SearchState state = accepted_in(hidden_effect_named("coulomb_friction").job(),
                                  {{"dahl_friction", {{5.0}, {1e-5}}}});
  ASSERT_TRUE(state.current().fit.parameters.back().uncertainty.at_bound);
  EXPECT_TRUE(drop_undetermined(state, state.current(), kContext));
  EXPECT_TRUE(state.accepted().empty());
  EXPECT_EQ(state.outcomes.list()[0].rejection->test, Rejection::Test::bound);
}

// Dahl friction without a length is Coulomb friction, which is in the catalogue.
TEST(DropDegenerate, TakesOutWhatHasBecomeASimplerEffect) {
  SearchState state = accepted_in(hidden_effect_named("coulomb_friction").job(),
                                  {{"dahl_friction", {{5.0}, {1e-5}}}});
  ASSERT_TRUE(state.current().fit.parameters.back().uncertainty.at_bound);
  EXPECT_TRUE(drop_degenerate(state, 2, kContext));
  EXPECT_TRUE(state.accepted().empty());
  ASSERT_EQ(state.degenerate.size(), 1u);
  EXPECT_EQ(state.degenerate[0].name, "dahl_friction");
  EXPECT_EQ(state.outcomes.list()[0].rejection->test, Rejection::Test::bound);
  EXPECT_FALSE(drop_degenerate(state, 2, kContext));
}

TEST(DropDegenerate, TakesOutWhatWasFoundBesideIt) {
  Model<double> truth = slide();
  hidden_effect_named("coulomb_friction").put_into(truth);
  hidden_effect_named("stroke_spring").put_into(truth);
  SearchState state =
      accepted_in(two_recordings(truth, slide(), {"M", "B_a"}),
                  {{"dahl_friction", {{5.0}, {1e-5}}}, {"stroke_spring", {{20.0}, {}}}});
  ASSERT_EQ(names_in(state), (Names{"dahl_friction", "stroke_spring"}));
  EXPECT_TRUE(drop_degenerate(state, 2, kContext));
  EXPECT_TRUE(state.accepted().empty());
  ASSERT_EQ(state.degenerate.size(), 1u);
  EXPECT_EQ(state.degenerate[0].name, "dahl_friction");
  EXPECT_EQ(state.outcomes.list()[1].hypothesis.name, "stroke_spring");
  EXPECT_EQ(state.outcomes.list()[1].reason, Reason::falls_with);
  EXPECT_EQ(state.outcomes.list()[1].other, "dahl_friction");
}

TEST(DropDegenerate, PutsThePlainEffectInItsPlace) {
  Model<double> truth = slide();
  hidden_effect_named("coulomb_friction").put_into(truth);
  hidden_effect_named("stroke_spring").put_into(truth);
  const Job job = two_recordings(truth, slide(), {"M", "B_a"});
  SearchState state =
      accepted_in(job, {{"dahl_friction", {{5.0}, {1e-5}}}, {"stroke_spring", {{20.0}, {}}}});
  ASSERT_EQ(names_in(state), (Names{"dahl_friction", "stroke_spring"}));
  state.chain.accepted()[0].rivals.push_back(
      {std::make_shared<const Hypothesis>(*find(catalogue(job, scales()), "coulomb_friction"))});
  EXPECT_TRUE(drop_degenerate(state, 2, kContext));
  EXPECT_EQ(names_in(state), (Names{"stroke_spring", "coulomb_friction"}));
  ASSERT_EQ(state.degenerate.size(), 1u);
  EXPECT_EQ(state.degenerate[0].name, "dahl_friction");
  EXPECT_NEAR(state.current().fit.parameters.back().value, 5.0, 0.2);
  EXPECT_EQ(state.outcomes.list().back().round, 2);
  EXPECT_EQ(state.outcomes.list().back().reason, Reason::explains_best);
  EXPECT_FALSE(drop_degenerate(state, 2, kContext));
}

// A gain of the velocity is most of what is missing. Of what repeats along the motion, only what
// does so a few times could imitate it.
TEST(DropImitators, KeepsWhatRepeatsManyTimes) {
  Model<double> truth = slide();
  hidden_effect_named("velocity.gain").put_into(truth);
  add_effect<PeriodicForce>(truth) = {4.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.01};
  const Job job = two_recordings(truth, slide(), {"M", "B_a"});
  const auto found = [&](const SearchOptions& options) {
    SearchState state = accepted_in(job, {{"periodic_force", {{4.0, 3.0}, {0.01}}}});
    drop_imitators(state, {options});
    drop_unreplicated_of_a_poor_model(state, {options});
    return names_in(state);
  };
  SearchOptions strict;
  strict.replication.far = 1e9;  // nothing is alike elsewhere
  EXPECT_EQ(found(strict), Names{"periodic_force"});
  strict.far_from_noise.periods = 1e9;
  EXPECT_EQ(found(strict), Names{});
}

TEST(RejectionOfAll, IsForAModelThatLeavesMostOfTheError) {
  Model<double> truth = slide();
  hidden_effect_named("coulomb_friction").put_into(truth);
  hidden_effect_named("velocity.gain").put_into(truth);
  SearchState state = accepted_in(two_recordings(truth, slide(), {"M", "B_a"}),
                                  {{"coulomb_friction", {{4.0}, {}}}});
  const auto rejection = rejection_of_all(state, {});
  ASSERT_TRUE(rejection);
  EXPECT_EQ(rejection->test, Rejection::Test::share);
  EXPECT_LT(rejection->found, 50.0);
  SearchOptions content;
  content.far_from_noise.of_model = 0.9 * rejection->found;
  EXPECT_FALSE(rejection_of_all(state, content));
}

TEST(RejectionOfAll, IsNoneWhereTheModelExplains) {
  SearchState state = accepted_in(hidden_effect_named("coulomb_friction").job(),
                                  {{"coulomb_friction", {{4.0}, {}}}});
  EXPECT_FALSE(rejection_of_all(state, {}));
}

TEST(RecordReplications, TellsWhatTheOtherRecordingSays) {
  SearchState state = accepted_in(hidden_effect_named("coulomb_friction").job(),
                                  {{"coulomb_friction", {{4.0}, {}}}});
  record_replications(state, kContext);
  const auto& replication = state.outcomes.list()[0].replication;
  ASSERT_TRUE(replication);
  EXPECT_TRUE(replication->is_alike);
  EXPECT_NEAR(replication->parameters[0].value, 5.0, 0.2);
}

}  // namespace
}  // namespace axisfit
