#include "fit/search/strategies.h"

#include <gtest/gtest.h>

#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

std::set<std::string> names_in(const SearchState& state) {
  std::set<std::string> names;
  for (const Accepted& a : state.accepted()) names.insert(a.hypothesis.name);
  return names;
}

SearchState start_of(const Job& job, const Rounds& rounds) {
  return {ModelChain({"", job, estimate(job)}, rounds.context)};
}

TEST(Named, AddsWhatPassesAndEndsWhereNothingMoreDoes) {
  Rounds rounds;
  SearchState state =
      named(start_of(hidden_effect_named("coulomb_friction").job(), rounds), rounds);
  EXPECT_EQ(names_in(state), std::set<std::string>{"coulomb_friction"});
  EXPECT_TRUE(state.explained());
  EXPECT_FALSE(state.interrupted);
  EXPECT_EQ(rounds.count, 2);  // the second finds nothing
  EXPECT_EQ(state.outcomes.list().front().round, 1);
}

// The Gaussian law is no start for Tustin's, nor is it richer.
TEST(Named, ChoosesBetweenTheLawsOfStribeck) {
  for (const double exponent : {1.0, 2.0}) {
    Model<double> truth = slide();
    add_effect<CoulombFriction>(truth).F_c = 15.0;
    add_effect<StribeckFriction>(truth) = {20.0, 0.1, exponent};
    Rounds rounds;
    const SearchState state =
        named(start_of(two_recordings(truth, slide(), {"M", "B_a"}), rounds), rounds);
    EXPECT_EQ(names_in(state), (std::set<std::string>{"coulomb_friction", "stribeck_friction"}));
    const auto& found = std::get<StribeckFriction<double>>(state.current().job.model.effects);
    EXPECT_EQ(found.n, exponent);
  }
}

TEST(Named, KeepsWhatItHasWhenItIsStopped) {
  StopFlag stop;
  Rounds rounds;
  int scored = 0;
  rounds.context.run = {&stop, nullptr, [&](const Progress& p) {
                          if (p.phase == "scoring effects" && ++scored == 2) stop.set();
                        }};
  const SearchState state =
      named(start_of(hidden_effect_named("coulomb_friction").job(), rounds), rounds);
  EXPECT_TRUE(state.interrupted);
  EXPECT_EQ(names_in(state), std::set<std::string>{"coulomb_friction"});
}

TEST(Together, ReturnsToTheDeclaredModelWhereItFindsNothingNew) {
  Rounds rounds;
  const SearchState found =
      named(start_of(hidden_effect_named("coulomb_friction").job(), rounds), rounds);
  const SearchState again = together(found, rounds);
  EXPECT_TRUE(again.accepted().empty());
  EXPECT_EQ(values_of(again.current().fit), values_of(found.chain.declared().fit));
}

TEST(Together, IsStoppedByAnException) {
  StopFlag stop;
  Rounds rounds;
  const SearchState state = start_of(hidden_effect_named("coulomb_friction").job(), rounds);
  rounds.context.run.stop = &stop;
  stop.set();
  EXPECT_THROW(together(state, rounds), Interrupted);
}

TEST(WithCurves, ExplainsByACurveWhatNoNamedEffectIsLeftFor) {
  Rounds rounds;
  // A wave along the stroke, steeper than any named effect but periodic_force allows: without it.
  Model<double> truth = slide();
  auto& force = add_effect<PeriodicForce>(truth);
  force.F_s1 = 6.0;
  force.period = 0.4;
  SearchState state = start_of(two_recordings(truth, slide(), {"M", "B_a"}), rounds);
  state = with_curves(std::move(state), rounds);
  EXPECT_EQ(names_in(state), std::set<std::string>{"force_over_position"});
}

TEST(Search, GivesTheLastValidStateWhenALaterStrategyIsStopped) {
  // Noise that is larger than stated: no strategy explains it, so that all of them run.
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  for (Recording& r : job.recordings)
    for (Measurement& m : r.measurements) m.sigma *= 0.7;
  StopFlag stop;
  Rounds rounds;
  const SearchState first = start_of(job, rounds);
  rounds.context.run = {&stop, nullptr, [&](const Progress& p) {
                          if (p.phase == "search") stop.set();  // after the first round
                        }};
  const SearchState found = search(first, rounds);
  EXPECT_TRUE(found.interrupted);
  EXPECT_TRUE(found.accepted().empty());
  EXPECT_EQ(values_of(found.current().fit), values_of(first.current().fit));
}

// A part of what is left may be noise that is larger than stated: plain rounds end such a search.
TEST(Search, EndsWithPlainRoundsWhereLittleIsLeft) {
  Job job = hidden_effect_named("coulomb_friction").job();
  for (Recording& r : job.recordings)
    for (Measurement& m : r.measurements) m.sigma *= 0.8;
  std::set<std::string> phases;
  Rounds rounds;
  SearchState state = start_of(job, rounds);
  rounds.context.run.progress = [&](const Progress& p) { phases.insert(p.phase); };
  state = search(std::move(state), rounds);
  EXPECT_EQ(names_in(state), std::set<std::string>{"coulomb_friction"});
  EXPECT_FALSE(state.explained());
  const double left = state.current().fit.reduced_chi_square;
  EXPECT_GT(left, 1.3);
  EXPECT_LT(left, 2.0);
  EXPECT_EQ(rounds.count, 3);  // what is missing, nothing more, and no curve
  EXPECT_FALSE(phases.contains("do two effects hide each other?"));
  EXPECT_TRUE(std::ranges::none_of(phases, [](const std::string& phase) {
    return phase.ends_with("replicate?") || phase.starts_with("do held-out blocks");
  }));
}

TEST(Search, LooksNoFurtherWhereTheFittedRecordingHasNothingLeft) {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  job.recordings[1] = hidden_effect_named("coulomb_friction").job().recordings[1];
  Rounds rounds;
  SearchState found = search(start_of(job, rounds), rounds);
  EXPECT_TRUE(found.accepted().empty());
  EXPECT_FALSE(found.explained());
  EXPECT_EQ(rounds.count, 1);
}

TEST(Search, BeginsWithASimulationThatTracksWhereTheFreeRunIsLost) {
  Model<double> truth = paper_axis();
  add_effect<CoulombFriction>(truth).F_c = 40.0;
  const Job job = two_recordings(truth, paper_axis(), {"B_a"});
  Rounds rounds;
  const SearchState first = start_of(job, rounds);
  const double free_run = first.current().fit.reduced_chi_square;
  ASSERT_GT(free_run, 25.0);
  double scored = 0.0;
  rounds.context.run.progress = [&](const Progress& p) {
    if (p.phase == "scoring effects" && scored == 0.0) scored = p.best;
  };
  SearchState found = search(first, rounds);
  EXPECT_EQ(names_in(found), std::set<std::string>{"coulomb_friction"});
  EXPECT_TRUE(found.explained());
  EXPECT_GT(scored, 0.0);
  EXPECT_LT(scored, free_run);
  EXPECT_EQ(found.current().fit.observer_gain, 0.0);
}

// A push has no name but that of a curve, and sends the free run elsewhere for the rest of the
// recording.
TEST(Search, FindsAPushWhileItTracks) {
  Model<double> truth = paper_axis();
  auto& push = add_effect<ForceOverTime>(truth);
  *members(truth)[quantity_index("force_over_time.from")] = 0.2;
  *members(truth)[quantity_index("force_over_time.to")] = 0.3;
  std::fill(push.c.begin() + 3, push.c.end() - 3, 150.0);
  const Job job = two_recordings(truth, paper_axis(), {"B_a"});
  Rounds rounds;
  const SearchState first = start_of(job, rounds);
  ASSERT_GT(first.current().fit.reduced_chi_square, 25.0);
  const SearchState found = search(first, rounds);
  EXPECT_EQ(names_in(found), std::set<std::string>{"force_over_time"});
  EXPECT_LE(rounds.count, 3);
  EXPECT_EQ(found.current().fit.observer_gain, 0.0);
}

// In one recording, so weak that the free run stays close: no law is behind it.
TEST(Search, LooksForNoPairBehindAPush) {
  Model<double> truth = paper_axis();
  auto& push = add_effect<ForceOverTime>(truth);
  *members(truth)[quantity_index("force_over_time.from")] = 0.2;
  *members(truth)[quantity_index("force_over_time.to")] = 0.3;
  std::fill(push.c.begin() + 3, push.c.end() - 3, 30.0);
  Job job = two_recordings(truth, paper_axis(), {"B_a"});
  job.recordings[1] = two_recordings(paper_axis(), paper_axis(), {"B_a"}).recordings[1];
  Rounds rounds;
  const SearchState first = start_of(job, rounds);
  ASSERT_LT(first.current().fit.reduced_chi_square, 25.0);
  std::set<std::string> phases;
  rounds.context.run.progress = [&](const Progress& p) { phases.insert(p.phase); };
  const SearchState found = named(first, rounds);
  EXPECT_TRUE(found.accepted().empty());
  EXPECT_TRUE(phases.contains("scoring effects"));
  EXPECT_FALSE(phases.contains("do two effects hide each other?"));
}

// A part that swings weighs something, too. While the simulation tracks, another inertia of the
// motor does as well as the mass.
TEST(Search, LeavesTrackingAsSoonAsTheFreeRunIsNear) {
  Model<double> truth = paper_axis();
  add_effect<ElasticMode>(truth) = {30.0, 15.2, 0.027};
  add_effect<AddedMass>(truth).dM = 30.0;
  const Job job = two_recordings(truth, paper_axis(), {"V_L", "B_a", "b_g", "k_g", "T_p"});
  Rounds rounds;
  const SearchState first = start_of(job, rounds);
  ASSERT_GT(first.current().fit.reduced_chi_square, 25.0);
  const SearchState found = search(first, rounds);
  EXPECT_EQ(names_in(found), (std::set<std::string>{"elastic_mode", "added_mass"}));
  EXPECT_EQ(found.current().fit.observer_gain, 0.0);
}

TEST(Tracking, FitsByTheErrorsOneStepAhead) {
  const Job job = hidden_effect_named("coulomb_friction").job();
  const FittedModel declared{"", job, estimate(job)};
  const FittedModel tracked = tracking(declared, 30.0, {});
  EXPECT_EQ(tracked.fit.observer_gain, 30.0);
  EXPECT_EQ(declared.fit.observer_gain, 0.0);
  EXPECT_LT(tracked.fit.reduced_chi_square, declared.fit.reduced_chi_square);
}

}  // namespace
}  // namespace axisfit
