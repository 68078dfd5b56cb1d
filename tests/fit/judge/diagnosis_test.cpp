#include "fit/judge/diagnosis.h"

#include <gtest/gtest.h>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// The slide in a motion to and fro, with and without friction that nobody declared.
Job slide_with(double friction) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = friction;
  Job job;
  job.options.threads = 1;
  job.model = slide();
  job.recordings = {recorded(truth, fit_motion(), 1.2, 1)};
  job.free = {free_parameter("M", 20.0), free_parameter("B_a", 30.0)};
  return job;
}

TEST(Diagnosis, OfATrueModelIsExplained) {
  const Job job = slide_with(0.0);
  const Diagnosis diagnosis = diagnose(job, result_at_start(job));
  EXPECT_EQ(diagnosis.tests.size(), 2u);
  EXPECT_EQ(diagnosis.forces.size(), 1u);
  EXPECT_TRUE(diagnosis.explained);
}

TEST(Diagnosis, OneSeriesBeyondItsNoiseIsEnough) {
  Job job = slide_with(0.0);
  for (double& x : job.recordings[0].measurements[1].values.edit()) x += 0.1;
  const Diagnosis diagnosis = diagnose(job, result_at_start(job));
  EXPECT_TRUE(diagnosis.tests[0].explained);
  EXPECT_FALSE(diagnosis.tests[1].explained);
  EXPECT_FALSE(diagnosis.explained);
}

TEST(Diagnosis, OfNothingThatWasFittedExplainsNothing) {
  Job job = slide_with(0.0);
  FitResult result = result_at_start(job);
  for (Measurement& m : job.recordings[0].measurements) m.fitted = false;
  const Diagnosis diagnosis = diagnose(job, result);
  EXPECT_TRUE(diagnosis.tests.empty());
  EXPECT_FALSE(diagnosis.explained);
}

}  // namespace
}  // namespace axisfit
