#include "fit/judge/other_day.h"

#include <gtest/gtest.h>

#include "fit/judge/grade.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

Model<double> slide_with(double constant, double dry) {
  Model<double> model = slide();
  add_effect<ConstantForce>(model).F_0 = constant;
  add_effect<CoulombFriction>(model).F_c = dry;
  return model;
}

/// A slide fitted on one day and validated on another, on which it may be a different one.
struct TwoDays {
  explicit TwoDays(const Model<double>& other)
      : job(two_recordings(slide_with(5.0, 12.0), slide_with(4.0, 10.0),
                           {"M", "B_a", "constant_force.F_0", "coulomb_friction.F_c"})) {
    job.recordings[1] = recorded(other, validate_motion(), 1.2, 9);
    job.recordings[1].name = "validate";
    job.recordings[1].role = Role::validate;
    fit = estimate(job);
    diagnosis = diagnose(job, fit);
    days = other_days(job, fit, diagnosis);
  }

  Job job;
  FitResult fit;
  Diagnosis diagnosis;
  std::vector<OtherDay> days;
};

TEST(OtherDay, AnOffsetIsFoundAndNothingElse) {
  const TwoDays two(slide_with(40.0, 12.0));
  ASSERT_EQ(two.days.size(), 1u);
  const OtherDay& day = two.days[0];
  EXPECT_EQ(day.recording, 1u);
  ASSERT_EQ(day.differing, std::vector<std::size_t>{2});
  EXPECT_NEAR(day.parameters[0].value, 40.0, 4.0 * day.parameters[0].uncertainty.standard_error);
  EXPECT_GT(day.percent_before, 5.0);
  EXPECT_LT(day.percent, 2.0);
}

TEST(OtherDay, TakesTwoWhereOneIsNotEnough) {
  const TwoDays two(slide_with(40.0, 60.0));
  ASSERT_EQ(two.days.size(), 1u);
  EXPECT_EQ(two.days[0].differing, (std::vector<std::size_t>{2, 3}));
  EXPECT_NEAR(two.days[0].parameters[1].value, 60.0,
              4.0 * two.days[0].parameters[1].uncertainty.standard_error);
}

TEST(OtherDay, IsNoneForTheSameMachine) {
  EXPECT_TRUE(TwoDays(slide_with(5.0, 12.0)).days.empty());
}

TEST(OtherDay, IsAnotherPayloadToo) {
  Model<double> heavy = slide_with(5.0, 12.0);
  heavy.axis.M *= 1.3;
  const TwoDays two(heavy);
  ASSERT_EQ(two.days.size(), 1u);
  const OtherDay& day = two.days[0];
  ASSERT_EQ(day.differing, std::vector<std::size_t>{0});
  EXPECT_NEAR(day.parameters[0].value, heavy.axis.M,
              4.0 * day.parameters[0].uncertainty.standard_error);
}

// What none of these explains is another machine.
TEST(OtherDay, IsNoneForASpring) {
  Model<double> other = slide_with(5.0, 12.0);
  add_effect<StrokeSpring>(other).k_s = 150.0;
  EXPECT_TRUE(TwoDays(other).days.empty());
}

}  // namespace
}  // namespace axisfit
