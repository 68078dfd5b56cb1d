#include "fit/judge/grade.h"

#include <gtest/gtest.h>

#include <cmath>

namespace axisfit {
namespace {

using Reason = FitGrade::Reason;

/// A fit of one parameter to two recordings of a velocity of standard deviation one, of which the
/// second validates, judged as if it had ended so.
class GradeTest : public ::testing::Test {
 protected:
  GradeTest() {
    job_.free = {free_parameter("M", 10.0)};
    for (const char* name : {"levels", "move"}) {
      Recording& r = job_.recordings.emplace_back();
      r.name = name;
      Measurement& m = r.measurements.emplace_back();
      std::vector<double> values;
      for (int i = 0; i < 100; ++i) values.push_back(i % 2 ? 1.0 : -1.0);
      m.values = values;
      m.sigma = 0.01;
      RecordingResult& result = fit_.recordings.emplace_back();
      result.free_running.finished = true;
      SignalError& error = result.signals.emplace_back();
      error.sigma = 0.01;
      error.noise = NoiseSource::given;
      set_error(fit_.recordings.size() - 1, 0.01);
      MissingForce& force = diagnosis_.forces.emplace_back();
      force.found = true;
      force.rms = force.noise = 0.1;
      force.drive_rms = 10.0;
    }
    job_.recordings[1].role = Role::validate;
    fit_.verdict.kind = FitVerdict::Kind::usable;
    fit_.parameters = {{job_.free[0].id(), 10.0, {.determined = true, .standard_error = 0.1}}};
    diagnosis_.explained = true;
  }
  /// Nothing tells whether the forces are right.
  void hide_forces() {
    for (MissingForce& force : diagnosis_.forces) force.noise = force.drive_rms;
  }
  void set_error(std::size_t recording, double rmse) {
    SignalError& e = fit_.recordings[recording].signals[0];
    e.rmse = rmse;
    e.reduced_chi_square = std::pow(rmse / e.sigma, 2);
  }
  FitGrade grade() { return grade_of(job_, fit_, diagnosis_); }

  Job job_;
  FitResult fit_;
  Diagnosis diagnosis_;
};

TEST_F(GradeTest, AllNoiseIsExplained) {
  EXPECT_EQ(grade().grade, Grade::explained);
  EXPECT_EQ(grade().reason, Reason::none);
  EXPECT_TRUE(grade().is_usable());
  EXPECT_EQ(grade_of(job_, fit_, {}).grade, Grade::usable) << "nobody has looked";
}

TEST_F(GradeTest, NoMinimumIsNotConverged) {
  for (const auto kind : {FitVerdict::Kind::no_minimum, FitVerdict::Kind::not_simulated}) {
    fit_.verdict.kind = kind;
    EXPECT_EQ(grade().grade, Grade::not_converged);
    EXPECT_EQ(grade().reason, Reason::solver);
    EXPECT_FALSE(grade().is_usable());
  }
}

TEST_F(GradeTest, AResidualBeyondTheNoiseIsUsable) {
  diagnosis_.explained = false;
  SeriesTest test;
  test.series.recording = 1;
  test.unexplained_percent = 80.0;
  diagnosis_.tests = {SeriesTest(), test};
  set_error(1, 0.4);
  const FitGrade found = grade();
  EXPECT_EQ(found.grade, Grade::usable);
  EXPECT_EQ(found.reason, Reason::residual);
  EXPECT_EQ(found.recording, 1u);
  EXPECT_EQ(found.percent, 80.0);
}

TEST_F(GradeTest, AValidationThatIsNotFollowedMakesTheModelWrong) {
  hide_forces();
  set_error(1, 0.6);
  EXPECT_EQ(grade().grade, Grade::model_wrong);
  EXPECT_EQ(grade().reason, Reason::simulation);
  EXPECT_EQ(grade().recording, 1u);
  EXPECT_NEAR(grade().percent, 40.0, 0.1);
  set_error(1, 12.2);  // 610 % of the range
  EXPECT_LT(grade().percent, 0.0);
  job_.recordings[1].measurements[0].fitted = false;  // only compared
  EXPECT_EQ(grade().grade, Grade::explained);
  fit_.recordings[0].free_running.finished = false;
  EXPECT_EQ(grade().grade, Grade::model_wrong);
  EXPECT_TRUE(std::isnan(grade().percent));
}

TEST_F(GradeTest, NoiseProvesNothing) {
  hide_forces();
  job_.recordings[1].measurements[0].sigma = 1.0;
  fit_.recordings[1].signals[0].sigma = 1.0;
  set_error(1, 1.3);
  EXPECT_EQ(grade().grade, Grade::explained);
  fit_.recordings[1].signals[0].noise = NoiseSource::fit;  // the residual itself
  EXPECT_EQ(grade().grade, Grade::model_wrong);
}

TEST_F(GradeTest, AMissingForceOfHalfTheDrivesMakesTheModelWrong) {
  diagnosis_.forces[1].rms = 6.0;
  EXPECT_EQ(grade().grade, Grade::model_wrong);
  EXPECT_EQ(grade().reason, Reason::force);
  EXPECT_EQ(grade().recording, 1u);
  EXPECT_NEAR(grade().percent, 60.0, 0.1);
  diagnosis_.forces[1].noise = 4.0;  // most of it
  EXPECT_EQ(grade().grade, Grade::explained);
}

// A mass under a recorded force drifts away in a free run however right it is.
TEST_F(GradeTest, AFreeRunMayDriftWhereTheForcesAreRight) {
  set_error(0, 0.9);
  EXPECT_EQ(grade().grade, Grade::usable);
  EXPECT_EQ(grade().reason, Reason::drift);
  EXPECT_EQ(grade().recording, 0u);
  fit_.verdict.kind = FitVerdict::Kind::signal_not_followed;
  EXPECT_EQ(grade().reason, Reason::drift) << "though a constant follows it as well";
  diagnosis_.forces[0].rms = 2.0;  // but not for want of a force
  EXPECT_EQ(grade().grade, Grade::model_wrong);
  diagnosis_.forces[0].rms = diagnosis_.forces[0].noise = 2.0;
  EXPECT_EQ(grade().grade, Grade::model_wrong) << "one that noise hides proves nothing";
  EXPECT_EQ(grade_of(job_, fit_, {}).grade, Grade::model_wrong) << "nobody has looked";
}

TEST_F(GradeTest, UsesAreThoseOfTheRecordingsThatValidate) {
  for (std::size_t r = 0; r < 2; ++r) {
    Recording& recording = job_.recordings[r];
    std::vector<double> times, simulated;
    for (int i = 0; i < 100; ++i) {
      times.push_back(0.01 * i);
      // Beyond a hundredth of the range, and the noise, from the 60th sample on.
      simulated.push_back(recording.measurements[0].values[static_cast<std::size_t>(i)] +
                          (i < 60 ? 0.03 : 0.07));
    }
    recording.times = times;
    fit_.recordings[r].free_running.simulated = {simulated};
    diagnosis_.forces[r].rms = r == 0 ? 3.0 : 0.5;
  }
  FitUses uses = grade().uses;
  EXPECT_NEAR(uses.missing_force_percent.value(), 100.0 * std::sqrt(0.24) / 10.0, 1e-9);
  EXPECT_EQ(uses.force_recording, 1u);
  EXPECT_NEAR(uses.followed_for.value(), 0.59, 1e-9);
  EXPECT_FALSE(uses.is_followed_to_the_end);
  job_.recordings[1].role = Role::fit;
  uses = grade().uses;
  EXPECT_EQ(uses.force_recording, 0u) << "of all, where none validates";
  fit_.recordings[0].free_running.simulated = {job_.recordings[0].measurements[0].values};
  fit_.recordings[1] = fit_.recordings[0];
  EXPECT_TRUE(grade().uses.is_followed_to_the_end);
  diagnosis_.forces[0].noise = diagnosis_.forces[1].noise = 5.0;
  EXPECT_FALSE(grade().uses.missing_force_percent) << "noise hides it";
}

TEST_F(GradeTest, WhatDeterminesNothingSaysSo) {
  ParameterUncertainty& u = fit_.parameters[0].uncertainty;
  u = {};
  EXPECT_EQ(grade().grade, Grade::nothing_determined);
  u.at_bound = true;
  EXPECT_EQ(grade().grade, Grade::nothing_determined);
  u.lower = 0.1;
  u.upper = 0.11;  // of 1e-3 to 1e5: near the bound for certain
  EXPECT_EQ(grade().grade, Grade::explained);
  u.upper = 500.0;
  EXPECT_EQ(grade().grade, Grade::nothing_determined);
}

// Its sigma is that of its readings: nothing moves.
TEST_F(GradeTest, NothingIsDeterminedWhereNothingMoves) {
  job_.recordings[0].measurements[0].sigma = 1.0;
  EXPECT_EQ(grade().grade, Grade::nothing_determined);
  EXPECT_EQ(grade().reason, Reason::standstill);
  job_.recordings[0].measurements[0].sigma = 0.3;
  EXPECT_EQ(grade().grade, Grade::explained);
  // What is only compared may rest.
  job_.recordings[0].measurements[0].sigma = 1.0;
  job_.recordings[0].measurements.push_back(job_.recordings[0].measurements[0]);
  job_.recordings[0].measurements[0].fitted = false;
  job_.recordings[0].measurements[1].sigma = 0.01;
  EXPECT_NE(grade().grade, Grade::nothing_determined);
}

TEST_F(GradeTest, AConstantThatDoesAsWellMakesTheModelWrong) {
  hide_forces();
  fit_.verdict = {.kind = FitVerdict::Kind::signal_not_followed, .recording = 1};
  EXPECT_EQ(grade().grade, Grade::model_wrong);
  EXPECT_EQ(grade().recording, 1u);
}

}  // namespace
}  // namespace axisfit
