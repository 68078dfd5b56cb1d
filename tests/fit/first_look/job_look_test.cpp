#include "fit/first_look/job_look.h"

#include <gtest/gtest.h>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// Of a slide that is simulated with dry friction, and declared with another mass.
Job sliding_job() {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = 12.0;
  return two_recordings(truth, slide(), {"M"}, 6.0, {Signal::position, Signal::velocity});
}

TEST(JobLook, SeesMassAndFriction) {
  const auto look = look_at(sliding_job());
  ASSERT_TRUE(look);
  EXPECT_EQ(look->direction, FirstLook::Direction::along);
  EXPECT_NEAR(look->mass.value, 20.0, 0.4);
  EXPECT_NEAR(look->coulomb.value, 12.0, 1.5);
  EXPECT_LT(look->unexplained, 0.05);
}

TEST(JobLook, SeesAForceThatIsTurned) {
  Job job = sliding_job();
  job.model.axis.K_f *= -1.0;
  const auto look = look_at(job);
  ASSERT_TRUE(look);
  EXPECT_EQ(look->direction, FirstLook::Direction::turned);
}

TEST(JobLook, LooksAtSourcesOfForceAlone) {
  Job job = two_recordings(motor_axis(), motor_axis(), {"B_a"});
  EXPECT_FALSE(look_at(job));
  job = sliding_job();
  job.recordings[0].command.meaning = Meaning::reference;
  EXPECT_FALSE(look_at(job));
}

}  // namespace
}  // namespace axisfit
