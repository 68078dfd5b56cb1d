// Recordings on which --init once went wrong, of machines that were simulated by programs that
// share nothing with this project (testdata/README.md): what is true of them is found without an
// edit.
#include <gtest/gtest.h>

#include <algorithm>

#include "fit/run.h"
#include "tests/init/made_job.h"

namespace axisfit {
namespace {

class ContactTest : public InitJobTest {
 protected:
  InitialJob contact(const std::vector<std::string>& files, std::optional<double> gain = {}) {
    std::vector<std::string> paths;
    for (const std::string& file : files) paths.push_back(AXISFIT_TESTDATA "/contact/" + file);
    return make(paths, {}, gain);
  }
  /// The fit of the job that was made.
  FitResult fit() {
    job_ = read().job;
    return estimate(job_);
  }
  const ParameterResult& of(const FitResult& result, const std::string& name) const {
    for (const ParameterResult& p : result.parameters)
      if (job_.entry(p.id.quantity).name == name) return p;
    throw std::logic_error("not free: " + name);
  }

  Job job_;
};

// Of two recordings that are fitted one carries a payload: no force along the stroke.
TEST_F(ContactTest, AMassThatChangesIsOne) {
  contact({"masschange-r0.csv", "masschange-r1.csv"}, 50.0);
  job_ = read().job;
  for (Recording& r : job_.recordings) r.role = Role::fit;
  const EffectSelection found = select_effects(job_, estimate(job_));
  EXPECT_EQ(found.verdict.accepted, std::vector<std::string>{"added_mass@masschange-r1"});
  const ParameterResult& payload = found.result.fit.parameters.back();
  EXPECT_EQ(payload.id.recording, 1u);
  EXPECT_NEAR(payload.value, 6.0, 0.15);
  EXPECT_NEAR(of(found.result.fit, "M").value, 20.0, 0.15);
}

// Friction that bends before it slips hides the mass: as a mass of its own it came out below zero,
// and the torque was turned for that.
TEST_F(ContactTest, AJointOfFrictionThatBuildsUpIsOne) {
  const InitialJob made = contact({"joint-friction-dominated.csv"});
  ASSERT_TRUE(made.look);
  EXPECT_EQ(made.look->direction, FirstLook::Direction::along);
  EXPECT_GT(made.look->dissipation.distance(), 10.0);
  const FitResult found = fit();
  ASSERT_TRUE(found.is_usable()) << found.message;
  EXPECT_NEAR(of(found, "B_a").value, 0.06, 0.003);
  EXPECT_NEAR(of(found, "dahl_friction.T_d").value, 0.22, 0.003);
  EXPECT_NEAR(of(found, "dahl_friction.l_d").value, 0.03, 0.001);
}

TEST_F(ContactTest, AFrictionThatIsNoneIsZero) {
  contact({"no-viscous-friction.csv"});
  const FitResult found = fit();
  ASSERT_TRUE(found.is_usable()) << found.message;
  EXPECT_NEAR(of(found, "J").value, 2.2e-4, 1e-6);
  EXPECT_NEAR(of(found, "coulomb_friction.T_c").value, 0.02, 2e-4);
  const ParameterResult& viscous = of(found, "B_a");
  EXPECT_EQ(viscous.uncertainty.verdict(), ParameterVerdict::at_zero);
  EXPECT_LT(viscous.uncertainty.upper, 1e-5);
  // The velocity reads 2 ms late and the position in time; the torque holds for a sample.
  EXPECT_EQ(job_.recordings[0].command.hold, Hold::zero_order);
  EXPECT_NEAR(of(found, "T_d").value, 0.001, 1e-4);
}

TEST_F(ContactTest, TenHertzAreEnough) {
  contact({"ten-hertz.csv"});
  const FitResult found = fit();
  ASSERT_TRUE(found.is_usable()) << found.message;
  EXPECT_NEAR(of(found, "M").value, 200.0, 30.0);
  EXPECT_NEAR(of(found, "coulomb_friction.F_c").value, 15.0, 2.0);
}

TEST_F(ContactTest, AMotorGoesWithItsOwnCurrent) {
  contact({"two-motors.csv"}, 1.0);
  const FitResult found = fit();
  ASSERT_TRUE(found.is_usable()) << found.message;
  EXPECT_LT(found.reduced_chi_square, 1.2);
}

TEST_F(ContactTest, TheReferenceIsNotFitted) {
  contact({"q-and-q-des.csv"});
  const FitResult found = fit();
  ASSERT_TRUE(found.is_usable()) << found.message;
  EXPECT_NEAR(of(found, "J").value, 0.5, 1e-3);
  EXPECT_NEAR(of(found, "B_a").value, 0.4, 0.01);
}

TEST_F(ContactTest, AVoltageThatStaysInStepsIsHeld) {
  contact({"elevator-quasistatic-forward.csv", "elevator-dynamic-forward.csv",
           "elevator-dynamic-reverse.csv", "elevator-quasistatic-reverse.csv"},
          1.0);
  const FitResult found = fit();
  ASSERT_TRUE(found.is_usable()) << found.message;
  for (const Recording& r : job_.recordings) EXPECT_EQ(r.command.hold, Hold::zero_order);
  EXPECT_NEAR(of(found, "M").value, 0.327, 0.003);
  EXPECT_NEAR(of(found, "B_a").value, 3.060, 0.003);
  EXPECT_NEAR(of(found, "coulomb_friction.F_c").value, 1.01, 0.003);
  EXPECT_NEAR(std::abs(of(found, "constant_force.F_0").value), 0.211, 0.003);
}

TEST_F(ContactTest, WhatArrivesInFramesCountsOnce) {
  const InitialJob made = contact({"ramp-frames.csv"}, 1.0);
  ASSERT_TRUE(made.look);
  EXPECT_FALSE(made.look->shows_delay(0.005)) << "the lag of the frames is none of the axis";
  const FitResult found = fit();
  ASSERT_TRUE(found.is_usable()) << found.message;
  for (const Measurement& m : job_.recordings[0].measurements) EXPECT_EQ(m.hold, 4u);
  EXPECT_NEAR(of(found, "J").value, 0.01, 1e-4);
  EXPECT_NEAR(of(found, "B_a").value, 0.12, 1e-6);
}

// Steps of one size show friction only together with the gain: what they do not tell is not said.
TEST_F(ContactTest, AStepInTheFirstSampleIsNoSpeed) {
  contact({"step-at-start-a.csv", "step-at-start-b.csv"}, 1.0);
  const FitResult found = fit();
  ASSERT_TRUE(found.is_usable()) << found.message;
  for (const Recording& r : job_.recordings)
    for (const auto& [quantity, value] : r.overrides)
      EXPECT_NEAR(value, 0.0, 1e-6) << "the axis begins at rest";
}

// Both cannot be right: the velocity is compared, and asked about.
TEST_F(ContactTest, AVelocityThatContradictsThePositionIsAskedAbout) {
  const InitialJob made = contact({"scale-wrong-r0.csv"});
  EXPECT_TRUE(std::ranges::any_of(made.guesses, [](const std::string& guess) {
    return guess.starts_with("velocity_mps: it is 0.80015 times the derivative of the position");
  }));
  job_ = read().job;
  const Measurement* velocity = job_.recordings[0].find(Signal::velocity);
  ASSERT_NE(velocity, nullptr);
  EXPECT_FALSE(velocity->fitted);
  const RunResult result = run(job_);
  EXPECT_EQ(result.grade.reason, FitGrade::Reason::contradiction);
  EXPECT_NE(result.grade.grade, Grade::explained);
}

TEST_F(ContactTest, ACurrentAtTheEndOfItsSensorIsSaid) {
  contact({"clipped-r0.csv"});
  const ValueCheck command = check_recording(read().job.recordings[0]).command;
  EXPECT_EQ(command.clipped, 101u);
  EXPECT_EQ(command.clipped_at, 1.2);
}

}  // namespace
}  // namespace axisfit
