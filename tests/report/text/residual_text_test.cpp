#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "report/text/report_text.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

TEST(ResidualTextTest, InstrumentsAreJudgedInTheirUnits) {
  const Job job = rubbing_file().job;
  ASSERT_EQ(job.recordings[0].measurements[0].sigma, 0.002);
  const auto told = [&](const SeriesTest& test) {
    Diagnosis diagnosis;
    diagnosis.tests.push_back(test);
    return on_one_line(instruments_text(job, diagnosis));
  };
  SeriesTest drifting;
  drifting.drift = {.per_second = 3.0, .standard_error = 0.1, .p_value = 1e-6, .span = -4.5};
  EXPECT_EQ(told(drifting),
            "The velocity of fitted drifts: its residual changes by 0.006 m/s per second, -0.009 "
            "m/s in total.");
  // An outlier's place is one of the series, which lacks what was left out.
  SeriesTest spoilt;
  spoilt.series.samples = {10, 20, 50};
  spoilt.series.values = {4.5, 0.5, -7.5};
  spoilt.outliers = {0, 2};
  ASSERT_EQ(job.recordings[0].times[50], 0.2);
  EXPECT_EQ(told(spoilt),
            "The velocity of fitted has 2 outliers, the largest 7.5 times the noise at 0.2 s: bad "
            "readings, or an event simulated one sample early or late.");
}

/// A test of a recording of the rubbing mass.
SeriesTest test_of(std::size_t recording, double unexplained,
                   std::vector<Dependence> dependences = {}) {
  SeriesTest test;
  test.series.recording = recording;
  test.series.fitted = recording == 0;
  test.explained = unexplained == 0.0;
  test.unexplained_percent = unexplained;
  test.reduced_chi_square = test.explained ? 1.0 : 2.0;
  test.dependences = std::move(dependences);
  return test;
}

TEST(ResidualTextTest, NamesTheThreeStrongestDependences) {
  const Job job = rubbing_file().job;
  Diagnosis diagnosis;
  diagnosis.tests = {test_of(0, 0.0), test_of(1, 12.34,
                                              {{"direction", 0.5, 0.0},
                                               {"velocity", 0.25, 0.0},
                                               {"time", 0.125, 0.0},
                                               {"command", 0.1, 0.0}})};
  EXPECT_EQ(on_one_line(residual_text(job, diagnosis)),
            "Residual beyond the noise, in per cent of its rms unexplained depends on (fraction "
            "explained) fitted, fit: velocity noise only judged, validate: velocity 12.3 % "
            "direction 50 %, velocity 25 %, time 12 %");
}

TEST(ResidualTextTest, OfInstrumentsIsNothingWhereTheyAreSound) {
  const Job job = rubbing_file().job;
  Diagnosis diagnosis;
  SeriesTest sound = test_of(0, 0.0);
  sound.resolution = job.recordings[0].measurements[0].sigma;
  sound.drift = {.per_second = 3.0, .standard_error = 0.1, .p_value = 0.01, .span = -4.5};
  diagnosis.tests = {sound};
  EXPECT_EQ(instruments_text(job, diagnosis), "");
  diagnosis.tests[0].resolution *= 1.5;
  EXPECT_EQ(instruments_text(job, diagnosis),
            "  The velocity of fitted has a resolution of 0.003 m/s.\n");
}

TEST(ResidualTextTest, OneOutlierIsOne) {
  const Job job = rubbing_file().job;
  Diagnosis diagnosis;
  diagnosis.tests = {test_of(0, 0.0)};
  diagnosis.tests[0].series.samples = {10};
  diagnosis.tests[0].series.values = {-7.5};
  diagnosis.tests[0].outliers = {0};
  EXPECT_NE(instruments_text(job, diagnosis).find("has 1 outlier, the largest 7.5 times"),
            std::string::npos);
}

/// A missing force of 5 N beside such a drive force.
MissingForce force_of(double drive_rms) {
  MissingForce force;
  force.found = true;
  force.cutoff = 40.0;
  force.rms = 5.0;
  force.noise = 0.25;
  force.drive_rms = drive_rms;
  return force;
}

TEST(ResidualTextTest, SuspectsHaveTheirEstimates) {
  const Job job = rubbing_file().job;
  Diagnosis diagnosis;
  diagnosis.forces.resize(2);
  EXPECT_EQ(suspected_effects_text(job, diagnosis, {}), "");
  Hypothesis friction;
  friction.name = "coulomb_friction";
  friction.acts_on = "friction";
  friction.strengths = {quantity_index("coulomb_friction.F_c")};
  std::vector<Scored> suspects(1);
  suspects[0].hypothesis = std::make_shared<const Hypothesis>(friction);
  suspects[0].own.strengths = {6.0412};
  suspects[0].fraction = 0.875;
  EXPECT_EQ(on_one_line(suspected_effects_text(job, diagnosis, suspects)),
            "Suspected effects, from the residual of the tracking simulation acts on explains "
            "estimate coulomb_friction friction 88 % F_c 6.04 N");
  diagnosis.forces[1] = force_of(20.0);
  const std::string text = on_one_line(suspected_effects_text(job, diagnosis, suspects));
  EXPECT_TRUE(text.starts_with(
      "Missing force on the arm rms from noise of drive force cutoff fitted - - - - judged 5 N "
      "0.25 N 25 % 40 Hz Suspected effects"))
      << text;
}

TEST(ResidualTextTest, AMissingTorqueIsNoForce) {
  EXPECT_EQ(force_cells("a", force_of(0.0), Joint::revolute),
            (std::vector<std::string>{"a", "5 N m", "0.25 N m", "-", "40 Hz"}));
}

TEST(ResidualTextTest, TheVerdictNamesTheWorstSignalAndItsCause) {
  const Job job = rubbing_file().job;
  std::vector<Scored> suspects;
  const auto verdict = [&](const Diagnosis& d, bool loop = false) {
    return on_one_line(residual_verdict(job, d, suspects, loop));
  };
  Diagnosis diagnosis;
  EXPECT_EQ(residual_verdict(job, diagnosis, suspects), "");
  diagnosis.tests = {test_of(0, 5.0), test_of(1, 12.34)};
  EXPECT_EQ(verdict(diagnosis),
            "Unexplained: up to 12.3 % of the residual, in the velocity of judged. No effect that "
            "axisfit knows explains it.");
  EXPECT_EQ(verdict(diagnosis, true),
            "Unexplained: up to 12.3 % of the residual, in the velocity of judged. No effect that "
            "axisfit knows explains it. The declared model does not fit: nothing can be said about "
            "effects yet.");
  Hypothesis friction;
  friction.name = "coulomb_friction";
  suspects.resize(2);
  suspects[0].hypothesis = std::make_shared<const Hypothesis>(friction);
  suspects[0].fraction = 0.049;
  EXPECT_EQ(verdict(diagnosis),
            "Unexplained: up to 12.3 % of the residual, in the velocity of judged. The cause is "
            "unknown: no effect that axisfit knows explains more than 4.9 % of it. To test the "
            "suspected effects, use --close-loop.");
  suspects[0].fraction = 0.4;
  EXPECT_EQ(verdict(diagnosis),
            "Unexplained: up to 12.3 % of the residual, in the velocity of judged. Most likely "
            "cause: coulomb_friction. To test the suspected effects, use --close-loop.");
  EXPECT_EQ(on_one_line(residual_verdict(job, diagnosis, suspects, false, false, {"judged"})),
            "Unexplained: up to 12.3 % of the residual, in the velocity of judged. See first what "
            "the warnings tell of judged: that may be the cause. Most likely cause: "
            "coulomb_friction. To test the suspected effects, use --close-loop.");
  for (SeriesTest& test : diagnosis.tests) test.series.input_noise = 1.5;
  EXPECT_NE(verdict(diagnosis).find("As much is left by "), std::string::npos);
  diagnosis.tests[1].series.input_noise = 1.0;  // not more than that
  EXPECT_EQ(verdict(diagnosis).find("As much is left by "), std::string::npos);
}

TEST(ResidualTextTest, TheVerdictLeavesOutRecordingsThatDiffer) {
  RunResult result;
  result.baseline = rubbing_file().job;
  result.diagnosis = Diagnosis{};
  result.diagnosis->tests = {test_of(0, 5.0), test_of(1, 12.34)};
  EXPECT_NE(residual_verdict(result).find("12.3 %"), std::string::npos);
  result.other_days = {{.recording = 1}};
  EXPECT_NE(residual_verdict(result).find("5 %"), std::string::npos);
  result.diagnosis->tests[0].explained = true;
  EXPECT_EQ(residual_verdict(result).find("Unexplained"), std::string::npos);
  result.grade.grade = Grade::nothing_determined;
  EXPECT_EQ(residual_verdict(result), "");
}

TEST(ResidualTextTest, TheVerdictOnNoiseSaysOfWhichData) {
  const Job job = rubbing_file().job;
  Diagnosis diagnosis;
  diagnosis.explained = true;
  diagnosis.tests = {test_of(0, 0.0)};
  EXPECT_EQ(on_one_line(residual_verdict(job, diagnosis, {})),
            "The residual shows no dependence on motion, position, command or time.");
  diagnosis.tests.push_back(test_of(1, 0.0, {{"time", 0.0625, 0.0}}));
  EXPECT_EQ(on_one_line(residual_verdict(job, diagnosis, {})),
            "Data that were not fitted are also explained down to the noise. A small dependence on "
            "time remains: at most 6.2 % of the mean square.");
}

}  // namespace
}  // namespace axisfit
