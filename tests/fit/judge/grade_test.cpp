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
    EXPECT_EQ(grade(), FitGrade{});
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

TEST_F(GradeTest, AFitThatTracksToTheEndMayDrift) {
  set_error(0, 0.9);
  fit_.observer_gain = 40.0;
  EXPECT_EQ(grade().grade, Grade::usable);
  EXPECT_EQ(grade().reason, Reason::tracking_only);
  EXPECT_EQ(grade().recording, 0u);
  diagnosis_.forces[0].rms = 2.0;  // but not for want of a force
  EXPECT_EQ(grade().grade, Grade::model_wrong);
}

TEST_F(GradeTest, WhatDeterminesNothingSaysSo) {
  ParameterUncertainty& u = fit_.parameters[0].uncertainty;
  u = {};
  EXPECT_EQ(grade().grade, Grade::nothing_determined);
  u.at_bound = true;
  EXPECT_EQ(grade().grade, Grade::nothing_determined);
  u.lower = 0.1;
  u.upper = 0.11;  // of 0.1 to 1000: near the bound for certain
  EXPECT_EQ(grade().grade, Grade::explained);
  u.upper = 500.0;
  EXPECT_EQ(grade().grade, Grade::nothing_determined);
}

TEST_F(GradeTest, AConstantThatDoesAsWellMakesTheModelWrong) {
  fit_.verdict = {.kind = FitVerdict::Kind::signal_not_followed, .recording = 1};
  EXPECT_EQ(grade().grade, Grade::model_wrong);
  EXPECT_EQ(grade().recording, 1u);
}

}  // namespace
}  // namespace axisfit
