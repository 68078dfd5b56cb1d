#include "fit/run.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/fit/estimate/tracking_job.h"

namespace axisfit {
namespace {

TEST(Run, TellsOfEveryModelWhatRestsOnGuesses) {
  Model<double> truth = slide();
  truth.structure.effects.set(*effect_named("coulomb_friction"));
  *members(truth)[quantity_index("coulomb_friction.F_c")] = 5.0;
  Job job = two_recordings(truth, slide(), {"M", "B_a"});
  job.guessed = {quantity_index("K_f")};
  const RunResult result = run(job, {.select_effects = true});
  ASSERT_TRUE(result.selection);
  ASSERT_EQ(result.selection->models.size(), 2u);
  const auto expect_known = [](const FitResult& fit) {
    for (const ParameterResult& p : fit.parameters) {
      ASSERT_EQ(p.rests_on.size(), 1u) << name_of(p.id);
      EXPECT_EQ(p.rests_on[0].id, id_of("K_f"));
      EXPECT_NEAR(p.rests_on[0].elasticity, 1.0, 1e-6);
    }
  };
  expect_known(result.first);
  expect_known(result.fit());
  for (const FittedModel& model : result.selection->models) expect_known(model.fit);
}

TEST(Run, GivesTheEffectsOfTheModelTheirLastEstimates) {
  Model<double> truth = slide();
  truth.structure.effects.set(*effect_named("coulomb_friction"));
  truth.structure.effects.set(*effect_named("stroke_spring"));
  *members(truth)[quantity_index("coulomb_friction.F_c")] = 5.0;
  *members(truth)[quantity_index("stroke_spring.k_s")] = 30.0;
  const RunResult result =
      run(two_recordings(truth, slide(), {"M", "B_a"}), {.select_effects = true});
  ASSERT_TRUE(result.selection);
  ASSERT_EQ(accepted(*result.selection),
            (std::set<std::string>{"coulomb_friction", "stroke_spring"}));
  for (const Outcome& trial : result.selection->effects) {
    if (!trial.in_model) continue;
    for (const ParameterResult& own : trial.parameters) {
      const auto& last = result.fit().parameters;
      const auto found = std::ranges::find(last, own.id, &ParameterResult::id);
      ASSERT_NE(found, last.end()) << name_of(own.id);
      EXPECT_EQ(own.value, found->value) << name_of(own.id);
      EXPECT_EQ(own.uncertainty.standard_error, found->uncertainty.standard_error)
          << name_of(own.id);
    }
  }
}

TEST(Run, ProfilesWhatIsFree) {
  const Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  EXPECT_THROW(run(job, {.profiles = {id_of("F_s")}}), std::invalid_argument);
  const auto profiled = [&](const RunOptions& options) {
    std::vector<std::size_t> places;
    for (const Profile& p : run(job, options).profiles) places.push_back(p.parameter);
    return places;
  };
  EXPECT_EQ(profiled({.profiles = {id_of("B_a")}}), (std::vector<std::size_t>{1}));
  EXPECT_EQ(profiled({.profiles = {id_of("B_a")}, .profile_all = true}),
            (std::vector<std::size_t>{1, 0}));
}

TEST(Run, TellsNothingOfTheParametersOfAWrongModel) {
  // A stiff spring that nobody declared.
  HiddenEffect spring = hidden_effect_named("stroke_spring");
  spring.strengths[0].second = 1000.0;
  Job job = two_recordings(spring.truth(), slide(), {"M", "B_a"});
  job.guessed = {quantity_index("K_f")};
  const RunResult result = run(job);
  ASSERT_EQ(result.grade.grade, Grade::model_wrong);
  for (const ParameterResult& p : result.first.parameters) EXPECT_TRUE(p.rests_on.empty());
}

/// The recording to fit moves less than that to validate: it never reaches a place where friction
/// is higher.
Job with_a_short_recording_to_fit() {
  Model<double> declared = slide();
  const auto put = [](Model<double>& model, const char* name, double value) {
    const QuantityEntry& entry = quantity_list()[quantity_index(name)];
    model.structure.effects.set(*effect_named(entry.group));
    *members(model)[entry.index] = value;
  };
  put(declared, "coulomb_friction.F_c", 5.0);
  Model<double> truth = declared;
  put(truth, "friction_bump.F_b", 12.0);
  put(truth, "friction_bump.y_b", 0.2);
  put(truth, "friction_bump.w_b", 0.01);
  const std::vector<Signal> signals{Signal::position, Signal::velocity};
  Job job = two_recordings(truth, declared, {"M", "B_a"}, 6.0, signals);
  job.recordings[0] = recorded(truth, fit_motion(3.0), 1.2, 2, signals);
  return job;
}

// A position that is 1.25 times too large tells another mass, with no more than noise in it.
TEST(Run, IsUsableAtMostWhereSignalsContradictEachOther) {
  Model<double> truth = slide();
  Job job = two_recordings(truth, slide(), {"M", "B_a"});
  job.recordings = {recorded(truth, fit_motion(), 2.0, 3, {Signal::position, Signal::velocity})};
  EXPECT_EQ(run(job).grade.grade, Grade::explained);
  job.recordings[0].measurements[1].fitted = false;
  for (double& x : job.recordings[0].measurements[0].values.edit()) x *= 1.25;
  const FitGrade grade = run(job).grade;
  EXPECT_EQ(grade.grade, Grade::usable);
  EXPECT_EQ(grade.reason, FitGrade::Reason::contradiction);
  EXPECT_EQ(grade.signal, Signal::velocity);
}

/// A run that is stopped when it comes to a phase that begins so.
RunResult stopped_at(const Job& job, const std::string& phase, const RunOptions& options = {}) {
  StopFlag stop;
  const auto progress = [&](const Progress& now) {
    if (now.phase.starts_with(phase)) stop.set();
  };
  RunResult result = run(job, options, {.stop = &stop, .progress = progress});
  EXPECT_TRUE(result.interrupted);
  return result;
}

// The friction moves the estimates when the gain is another one: that is most of their error.
TEST(StoppedRun, IsNoSurerThanAFinishedOne) {
  const Job job = tracking_job(true, 20.0);
  const RunResult whole = run(job);
  EXPECT_EQ(whole.errors_known, ErrorsKnown::fully);
  ASSERT_TRUE(whole.fit().parameters[0].budget.gain);
  for (const char* phase : {"analysing the residual", "does the observer gain matter?"}) {
    const RunResult stopped = stopped_at(job, phase);
    EXPECT_EQ(stopped.errors_known, ErrorsKnown::to_first_order);
    EXPECT_EQ(stopped.grade.grade, Grade::usable);
    for (std::size_t i = 0; i < job.free.size(); ++i) {
      const ParameterResult &early = stopped.fit().parameters[i], &late = whole.fit().parameters[i];
      EXPECT_EQ(early.value, late.value);
      EXPECT_EQ(early.budget.scatter.has_value(), late.budget.scatter.has_value());
      EXPECT_GT(early.uncertainty.standard_error, 0.7 * late.uncertainty.standard_error);
      EXPECT_EQ(early.budget.gain.has_value(), late.budget.gain.has_value());
      if (!late.budget.gain) continue;
      EXPECT_GT(early.uncertainty.standard_error, 1.5 * early.budget.sampling.standard_error);
    }
  }
}

TEST(StoppedRun, IsUsableAtMost) {
  const Job job = tracking_job(false, 10.0);
  EXPECT_EQ(run(job).grade.grade, Grade::explained);
  const RunResult stopped = stopped_at(job, "does the observer gain matter?");
  EXPECT_EQ(stopped.grade.grade, Grade::usable);
  EXPECT_EQ(stopped.grade.reason, FitGrade::Reason::stopped);
}

TEST(Run, ExchangesTheRolesWhereOnlyTheRecordingToValidateShowsAnEffect) {
  const RunResult result = run(with_a_short_recording_to_fit(), {.select_effects = true});
  ASSERT_TRUE(result.selection);
  EXPECT_TRUE(result.roles_exchanged);
  EXPECT_EQ(accepted(*result.selection), std::set<std::string>{"friction_bump"});
  EXPECT_TRUE(result.selection->explained);
  EXPECT_EQ(result.baseline.recordings[0].role, Role::validate);
  EXPECT_EQ(result.job().recordings[1].role, Role::fit);
  expect_found(*result.selection, "friction_bump.F_b", 12.0);
}

TEST(Run, KeepsTheRolesWhereTheRecordingsDoNotShowTheSame) {
  Job job = with_a_short_recording_to_fit();
  job.recordings[1].measurements.pop_back();
  const RunResult result = run(job, {.select_effects = true});
  ASSERT_TRUE(result.selection);
  EXPECT_FALSE(result.roles_exchanged);
  EXPECT_EQ(result.selection->verdict.kind, SelectionVerdict::Kind::none_passes);
  EXPECT_EQ(result.baseline.recordings[0].role, Role::fit);
}

}  // namespace
}  // namespace axisfit
