// The first guess of a mass with friction, against one that is integrated in small steps.
#include "init/force_balance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace axisfit {
namespace {

struct DrivenMass {
  std::vector<double> times, position, velocity, force;
};

/// M = 12 kg, B = 40 N s/m, F_c = 15 N and -4 N besides, driven both ways and never at rest.
DrivenMass driven() {
  DrivenMass run;
  constexpr double kStep = 1e-5, kSample = 1e-3;
  double x = 0.2, v = 0.0, next = 0.0;
  for (double t = 0.0; t < 4.0; t += kStep) {
    const double force = 70.0 * std::sin(9.0 * t) + 40.0 * std::sin(23.0 * t);
    if (t >= next - 0.5 * kStep) {
      run.times.push_back(t);
      run.position.push_back(x);
      run.velocity.push_back(v);
      run.force.push_back(force);
      next += kSample;
    }
    v += kStep * (force - 40.0 * v - (v > 0.0 ? 15.0 : -15.0) + 4.0) / 12.0;
    x += kStep * v;
  }
  return run;
}

TEST(ForceBalanceTest, FindsTheOrderOfEveryTerm) {
  const DrivenMass run = driven();
  for (const bool by_velocity : {false, true}) {
    const auto found = force_balance(run.times, by_velocity ? std::vector<double>() : run.position,
                                     by_velocity ? run.velocity : std::vector<double>(), run.force);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->mass, 12.0, 1.2);
    EXPECT_NEAR(found->viscous, 40.0, 8.0);
    EXPECT_NEAR(found->coulomb, 15.0, 4.0);
    EXPECT_NEAR(found->constant, -4.0, 1.0);
    EXPECT_GT(found->correlation, 0.95);
  }
}

TEST(ForceBalanceTest, ADriveThatActsAgainstTheMotionHasANegativeMass) {
  DrivenMass run = driven();
  for (double& f : run.force) f = -f;
  const auto found = force_balance(run.times, run.position, run.velocity, run.force);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->mass, -12.0, 1.2);
  EXPECT_LT(found->correlation, -0.95);
}

/// J = 0.02 kg m^2, B = 0.05 N m s/rad, T_c = 0.1 N m, and a weight of 0.8 N m that hangs at -0.3
/// rad.
TEST(ForceBalanceTest, FindsTheGravityOfAJoint) {
  DrivenMass run;
  constexpr double kStep = 1e-5, kSample = 1e-3;
  double q = 0.0, v = 0.0, next = 0.0;
  for (double t = 0.0; t < 6.0; t += kStep) {
    const double torque = 0.9 * std::sin(3.0 * t) + 0.6 * std::sin(11.0 * t);
    if (t >= next - 0.5 * kStep) {
      run.times.push_back(t);
      run.position.push_back(q);
      run.force.push_back(torque);
      next += kSample;
    }
    v += kStep * (torque - 0.05 * v - (v > 0.0 ? 0.1 : -0.1) - 0.8 * std::sin(q + 0.3)) / 0.02;
    q += kStep * v;
  }
  const auto found = force_balance(run.times, run.position, {}, run.force, true);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->mass, 0.02, 0.002);
  EXPECT_NEAR(found->coulomb, 0.1, 0.02);
  EXPECT_NEAR(found->gravity_sine, 0.8 * std::cos(0.3), 0.02);
  EXPECT_NEAR(found->gravity_cosine, 0.8 * std::sin(0.3), 0.02);
  EXPECT_GT(found->correlation, 0.99);
  EXPECT_FALSE(force_balance(run.times, {}, run.position, run.force, true)) << "no position";
}

TEST(ForceBalanceTest, OneSpeedTellsNothing) {
  DrivenMass run = driven();
  for (std::size_t i = 0; i < run.times.size(); ++i) run.position[i] = 0.3 * run.times[i];
  EXPECT_FALSE(force_balance(run.times, run.position, {}, run.force));
}

}  // namespace
}  // namespace axisfit
