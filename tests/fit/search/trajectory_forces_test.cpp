#include "fit/search/trajectory_forces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

std::size_t quantity(const std::string& name) { return quantity_index(name); }

Hypothesis hypothesis(const std::string& strength) {
  Hypothesis one;
  one.strengths = {quantity(strength)};
  return one;
}

TEST(TrajectoryForces, SmoothForcesAndSlowModesAreReadOff) {
  EXPECT_TRUE(is_read_off(hypothesis("quadratic_drag.c"), {2.0}, 1e-3));
  EXPECT_TRUE(is_read_off(hypothesis("stribeck_load_friction.mu_st"), {0.1}, 1e-3));
  EXPECT_TRUE(is_read_off(hypothesis("elastic_mode.m_e"), {100.0, 0.03}, 1e-3));
  EXPECT_FALSE(is_read_off(hypothesis("elastic_mode.m_e"), {200.0, 0.03}, 1e-3));
  EXPECT_FALSE(is_read_off(hypothesis("elastic_mode.m_e"), {100.0, 1.5}, 1e-3));
  EXPECT_FALSE(is_read_off(hypothesis("constant_force.F_0"), {}, 1e-3));
  EXPECT_FALSE(is_read_off(hypothesis("load_friction.mu"), {}, 1e-3));
  EXPECT_FALSE(is_read_off(hypothesis("M"), {}, 1e-3));
  Hypothesis probed = hypothesis("quadratic_drag.c");
  probed.probes = {1.0};
  EXPECT_FALSE(is_read_off(probed, {2.0}, 1e-3));
}

/// A slide that a spring of its own moves to and fro about its middle, y0 = cos(2 t) m.
std::vector<AxisInstant> swinging(const Model<double>& model, std::size_t samples) {
  std::vector<AxisInstant> list;
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    AxisInstant& at = list.emplace_back();
    at.input.time = t;
    at.state = {std::cos(2.0 * t), -2.0 * std::sin(2.0 * t)};
    at.mode = Equations<double>(model).mode_at(at.state, at.input);
  }
  return list;
}

Model<double> on_a_spring() {
  Model<double> model = slide();
  model.axis.B_a = 0.0;
  auto& spring = add_effect<StrokeSpring>(model);
  spring.k_s = 4.0 * Equations<double>(model).moving_mass();
  return model;
}

// Long after the start a damped mode follows the swing: q'' = -4 q, and q is the arm's
// acceleration, turned round, over w^2 - 4 and a little late.
TEST(TrajectoryForces, AModeFollowsASlowSwingAsTheTransferFunctionSays) {
  const Model<double> without = on_a_spring();
  Model<double> with = without;
  auto& mode = add_effect<ElasticMode>(with);
  mode.m_e = 0.0;
  mode.f_e = 3.0;
  mode.zeta_e = 0.5;
  const std::size_t samples = 4000;
  const Disturbances d =
      disturbances_of(with, without, std::vector<std::size_t>{quantity("elastic_mode.m_e")}, {},
                      swinging(without, samples));
  ASSERT_EQ(d.arm.rows(), static_cast<Eigen::Index>(samples));
  ASSERT_EQ(d.arm.cols(), 1);
  EXPECT_TRUE(d.motor.isZero(0.0));
  const double w = 2.0 * std::numbers::pi * mode.f_e, s = 2.0;
  const std::complex<double> part =
      s * s / std::complex<double>(w * w - s * s, 2.0 * mode.zeta_e * w * s);
  const double mass = Equations<double>(without).moving_mass();
  for (std::size_t i = 3000; i < samples; ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    // y1' = -4 cos(2 t), q = -y1' / (w^2 - s^2 + 2i zeta w s), the force -q'' = s^2 q.
    const double expected = 4.0 * (part * std::polar(1.0, s * t)).real() / mass;
    EXPECT_NEAR(d.arm(static_cast<Eigen::Index>(i), 0), expected, 1e-5 * 4.0 / mass) << t;
  }
}

TEST(TrajectoryForces, WhatShapesDoIsTheDifferenceOfTwoModes) {
  const Model<double> without = on_a_spring();
  const std::vector<AxisInstant> trajectory = swinging(without, 1000);
  const auto force = [&](double f_e, double zeta_e, const std::string& name) {
    Model<double> with = without;
    auto& mode = add_effect<ElasticMode>(with);
    mode.m_e = 2.0;
    mode.f_e = f_e;
    mode.zeta_e = zeta_e;
    return Eigen::VectorXd(
        disturbances_of(with, without, std::vector<std::size_t>{quantity("elastic_mode." + name)},
                        {}, trajectory)
            .arm.col(0));
  };
  const double h = 1e-4;
  const Eigen::VectorXd of_f = (force(5.0 + h, 0.1, "m_e") - force(5.0 - h, 0.1, "m_e")) *
                               (2.0 / (2.0 * h)),
                        of_zeta = (force(5.0, 0.1 + h, "m_e") - force(5.0, 0.1 - h, "m_e")) *
                                  (2.0 / (2.0 * h));
  EXPECT_LT((force(5.0, 0.1, "f_e") - of_f).norm(), 1e-5 * of_f.norm());
  EXPECT_LT((force(5.0, 0.1, "zeta_e") - of_zeta).norm(), 1e-5 * of_zeta.norm());
}

}  // namespace
}  // namespace axisfit
