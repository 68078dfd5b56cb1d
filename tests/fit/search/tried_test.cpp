#include "fit/search/tried.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/search/catalogue.h"
#include "sim/model.h"
#include "tests/fit/search/hypotheses.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

class AsSimplerTest : public testing::Test {
 protected:
  AsSimplerTest() {
    for (const char* name : {"B_a", "dahl_friction.F_d", "dahl_friction.l_d"}) {
      job_.free.push_back(free_parameter(name, 1.0));
      fit_.parameters.emplace_back().id = id_of(name);
    }
    hypothesis_.strengths = {quantity_index("dahl_friction.F_d")};
    hypothesis_.shapes = {quantity_index("dahl_friction.l_d")};
  }
  std::optional<Rejection> found() const { return rejection_as_simpler(job_, fit_, hypothesis_); }

  Job job_;
  FitResult fit_;
  Hypothesis hypothesis_;
};

TEST_F(AsSimplerTest, IsThatOfTheEffect) {
  EXPECT_EQ(found(), std::nullopt);
  fit_.parameters[0].uncertainty.at_bound = true;  // of the axis
  fit_.parameters[1].uncertainty.at_bound = true;  // a strength
  EXPECT_EQ(found(), std::nullopt);
  fit_.parameters[2].uncertainty.at_bound = true;
  EXPECT_EQ(found(),
            (Rejection{.test = Rejection::Test::bound, .parameter = id_of("dahl_friction.l_d")}));
}

TEST_F(AsSimplerTest, IsBeyondWhatWasTried) {
  hypothesis_.settings = {{1e-4}, {1e-2}};
  for (const double length : {1e-4, 1e-2, 2.9e-2, 3.5e-5}) {
    fit_.parameters[2].value = length;
    EXPECT_EQ(found(), std::nullopt) << length;
  }
  for (const double length : {3.1e-2, 3.2e-5}) {
    fit_.parameters[2].value = length;
    EXPECT_EQ(found(), (Rejection{.test = Rejection::Test::span,
                                  .found = length,
                                  .parameter = id_of("dahl_friction.l_d")}));
  }
}

TEST_F(AsSimplerTest, IsNoneWhereShapesAreNotEstimated) {
  fit_.parameters[2].uncertainty.at_bound = true;
  hypothesis_.held = hypothesis_.shapes.size();
  EXPECT_EQ(found(), std::nullopt);
}

/// Two fitted recordings, in the second of which a payload is picked up halfway.
Job with_a_payload_picked_up() {
  Model<double> truth = slide();
  Job job = two_recordings(truth, slide(), {"M", "B_a"});
  auto& payload = add_effect<PayloadChange>(truth);
  payload.dM = 5.0;
  payload.t_c = 0.6;
  job.recordings[1] = two_recordings(truth, slide(), {"M", "B_a"}).recordings[1];
  job.recordings[1].role = Role::fit;
  return job;
}

TEST(Judge, FindsTheShapesOfWhatOneRecordingHasAlone) {
  const Job job = with_a_payload_picked_up();
  const FitResult without = estimate(job);
  const SearchScales scales{-0.05, 0.2, 1.0, -1.0, 1.0, 0.0, 1.2, 1e-3};
  const std::vector<Hypothesis> all = catalogue(job, scales);
  const auto payload =
      std::ranges::find(all, "payload_change@" + job.recordings[1].name, &Hypothesis::name);
  ASSERT_NE(payload, all.end());
  Scored start;
  start.hypothesis = std::make_shared<const Hypothesis>(*payload);
  start.own = {{3.0}, {0.5}};
  start.others = values_of(without);
  const SearchContext context;
  Tried tried = try_hypothesis(job, start, context, {});
  ASSERT_TRUE(tried.fit.is_usable());
  EXPECT_NEAR(values_in(tried).shapes.front(), 0.6, 0.01);
  const Determination d =
      determination(tried.job, tried.fit, tried.hypothesis, tried.residuals, context.options);
  EXPECT_FALSE(d.at_bound || d.undetermined);
  EXPECT_GT(d.wald, d.required);
}

// A delay of a second, where four milliseconds are true: the motion is another one.
TEST(TryHypothesis, StartsFromAPartOfTheWayWhereAWholeStepGoesTooFar) {
  const Job job = hidden_effect_named("dead_time").job();
  const FitResult without = estimate(job);
  Scored start;
  start.hypothesis =
      std::make_shared<const Hypothesis>(*find(catalogue(job, scales()), "dead_time"));
  start.own = {{1.0}, {}};
  start.others = values_of(without);
  SearchContext hasty;
  hasty.options.refit.iterations = 4;
  EXPECT_GT(reduced_cost(try_hypothesis(job, start, hasty).fit), reduced_cost(without));
  for (const bool is_nearby : {false, true}) {
    const Try how{.before = &without, .is_nearby = is_nearby};
    EXPECT_LT(reduced_cost(try_hypothesis(job, start, hasty, how).fit), reduced_cost(without));
  }
}

TEST(PeriodsPassed, CountsThemAlongTheStroke) {
  Model<double> truth = slide();
  auto& wave = add_effect<PeriodicForce>(truth);
  wave.F_s1 = 12.0;
  wave.period = 0.015;
  const Job job = two_recordings(truth, truth, {"M", "B_a"});
  const FitResult fit = estimate(job);
  const auto [low, high] =
      std::ranges::minmax(fit.recordings[0].as_fitted().samples, {}, &Sample::position);
  Hypothesis periodic;
  periodic.strengths = {quantity_index("periodic_force.F_s1")};
  EXPECT_NEAR(periods_passed(job, fit, periodic), (high.position - low.position) / 0.015, 1e-9);
}

TEST(RejectionByForce, IsForOneThatRisesInAnyRecording) {
  const SearchOptions::Acceptance limits;
  EXPECT_EQ(rejection_by_force({12.5, 3.0}, {14.0, 2.0}, limits), std::nullopt);
  EXPECT_EQ(rejection_by_force({0.1, 3.0}, {1.9, 2.0}, limits), std::nullopt);
  EXPECT_EQ(rejection_by_force({12.5, NAN}, {10.0, 300.0}, limits), std::nullopt);
  EXPECT_EQ(rejection_by_force({3.0, 12.5}, {2.0, 343.0}, limits),
            (Rejection{.test = Rejection::Test::force, .found = 343.0, .required = 12.5}));
}

TEST(RejectionByFreeRun, IsForOneThatEndsEarlierInAnyRecording) {
  FitResult before, after;
  before.recordings.resize(2);
  before.recordings[1].free_running.finished = true;
  after = before;
  EXPECT_EQ(rejection_by_free_run(before, after), std::nullopt);
  after.recordings[0].free_running.finished = true;
  EXPECT_EQ(rejection_by_free_run(before, after), std::nullopt);
  after.recordings[1].free_running.finished = false;
  EXPECT_EQ(rejection_by_free_run(before, after), Rejection{.test = Rejection::Test::simulation});
}

TEST(RejectionAsIndistinct, IsForOneBesideWhichAParameterIsOpen) {
  FitResult before, after;
  before.parameters.resize(2);
  before.parameters[0].uncertainty = {.determined = true, .standard_error = 0.1};
  after = before;
  after.parameters.resize(3);
  EXPECT_EQ(rejection_as_indistinct(before, after), std::nullopt);
  after.parameters[0].uncertainty.standard_error = 5.0;
  EXPECT_EQ(rejection_as_indistinct(before, after), std::nullopt);
  const Rejection rejection{.test = Rejection::Test::distinct};
  after.parameters[0].uncertainty.standard_error = 50.0;
  EXPECT_EQ(rejection_as_indistinct(before, after), rejection);
  after.parameters[0].uncertainty = {};
  EXPECT_EQ(rejection_as_indistinct(before, after), rejection);
}

TEST(MissingPercents, AreOfTheRecordingsThatValidate) {
  const HiddenEffect secret = hidden_effect_named("coulomb_friction");
  Job job = secret.job();
  const std::vector<double> of_one = missing_percents(job, estimate(job));
  ASSERT_EQ(of_one.size(), 1u);
  EXPECT_NEAR(of_one[0], 1.26, 0.1);
  for (Recording& r : job.recordings) r.role = Role::fit;
  EXPECT_EQ(missing_percents(job, estimate(job)).size(), 2u);
}

TEST(Resume, GoesOnToTheMinimum) {
  const HiddenEffect secret = hidden_effect_named("drive_lag");
  Tried e;
  e.job = two_recordings(secret.truth(), secret.truth(), {"M", "B_a", "drive_lag.T_l"});
  const FitResult whole = refit(e.job, {}, 100);
  ASSERT_TRUE(whole.verdict.has_minimum());
  e.fit = refit(e.job, {}, 1);
  ASSERT_EQ(e.fit.verdict.kind, FitVerdict::Kind::no_minimum);
  resume(e);
  EXPECT_TRUE(e.fit.verdict.has_minimum());
  EXPECT_NEAR(e.fit.reduced_chi_square, whole.reduced_chi_square, 1e-5);
  for (std::size_t i = 0; i < e.job.free.size(); ++i)
    EXPECT_NEAR(e.fit.parameters[i].value, whole.parameters[i].value,
                0.05 * whole.parameters[i].uncertainty.standard_error);
  EXPECT_EQ(e.residuals.size(), residual_series(e.job, e.fit).size());
}

}  // namespace
}  // namespace axisfit
