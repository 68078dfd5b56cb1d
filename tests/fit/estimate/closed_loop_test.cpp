// Fits to recordings that have only the reference and the encoder of a servo drive.
#include <gtest/gtest.h>

#include "tests/fit/parameter_ids.h"
#include "tests/fit/servo.h"

namespace axisfit {
namespace {

TEST(ClosedLoop, GivesTheMassFromReferenceAndEncoderWhereTheGainsAreKnown) {
  const Servo servo;
  const FitResult fit = estimate(servo_job(servo));
  ASSERT_TRUE(fit.is_usable()) << fit.message;
  const double truth[]{servo.mass, servo.viscous, servo.coulomb};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(fit.parameters[i].value, truth[i], 0.01 * truth[i])
        << name_of(fit.parameters[i].id);
}

// The force of an ampere and all that it moves grow together; a gain of the controller that is free
// besides is told by the ratio.
TEST(ClosedLoop, TellsWhatItCannotTell) {
  const Servo servo;
  Job job = servo_job(servo);
  job.free.push_back(free_parameter("K_f", 80.0));
  const FitResult scaled = estimate(job);
  EXPECT_FALSE(scaled.parameters[0].uncertainty.determined);
  EXPECT_FALSE(scaled.parameters[3].uncertainty.determined);
  job.free.back() = free_parameter("controller.k_p", 10.0);
  const FitResult fit = estimate(job);
  ASSERT_TRUE(fit.is_usable()) << fit.message;
  EXPECT_NEAR(fit.parameters[3].value, servo.k_p, 0.01 * servo.k_p);
  EXPECT_NEAR(fit.parameters[0].value, servo.mass, 0.02 * servo.mass);
}

}  // namespace
}  // namespace axisfit
