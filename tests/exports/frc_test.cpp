#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "exports/export.h"
#include "tests/exports/axes.h"

namespace axisfit {
namespace {

using Json = nlohmann::json;

Json gains(const Rig& rig) {
  return Json::parse(only_file(export_axis(rig, ExportTarget::frc, "axis", "By a test")));
}

TEST(Frc, HasTheGainsInVolts) {
  Rig rig = rubbing_slide();  // 20 kg, 30 N s/m and 4 N at 40 N/V
  add_effect<ConstantForce>(rig.model).F_0 = -8.0;
  const Export made = export_axis(rig, ExportTarget::frc, "lift", "By a test");
  EXPECT_EQ(made.files.front().first, "lift.json");
  EXPECT_TRUE(made.lost.empty());
  const Json json = gains(rig);
  EXPECT_EQ(json.at("law"), "V = kS sign(v) + kV v + kA a + kG");
  EXPECT_EQ(json.at("kS"), Json({{"value", 0.1}, {"standard_error", nullptr}, {"unit", "V"}}));
  EXPECT_EQ(json.at("kV").at("value"), 0.75);
  EXPECT_EQ(json.at("kV").at("unit"), "V s/m");
  EXPECT_EQ(json.at("kA").at("value"), 0.5);
  EXPECT_EQ(json.at("kA").at("unit"), "V s^2/m");
  EXPECT_EQ(json.at("kG").at("value"), 0.2) << "holds what pulls down";
}

TEST(Frc, OfAMotorHasItsInertiaAndBackEmf) {
  Rig rig = slide();
  rig.model.structure.drive = Drive::motor_voltage;
  Axis<double>& a = rig.model.axis;
  a.r_g = 0.02;
  a.J_m = 0.0008;
  a.K_m = 0.3;
  a.R = 1.5;
  const Json json = gains(rig);
  EXPECT_DOUBLE_EQ(json.at("kV").at("value"), 3.0 + 15.0);  // B_a / 10 N/V + K_m / r_g
  EXPECT_DOUBLE_EQ(json.at("kA").at("value"), 2.2);         // M + J_m / r_g^2
}

TEST(Frc, OfAnArmHasItsOffset) {
  Rig rig = slide();
  rig.model.structure.joint = Joint::revolute;
  // kG cos(y + offset) for 0.5 V and 2 rad
  auto& gravity = add_effect<PendulumGravity>(rig.model);
  gravity.G_c = 20.0 * std::cos(2.0);
  gravity.G_s = -20.0 * std::sin(2.0);
  add_effect<ConstantForce>(rig.model).F_0 = 1.0;
  const Json json = gains(rig);
  EXPECT_EQ(json.at("law"), "V = kS sign(v) + kV v + kA a + kG cos(position + offset)");
  EXPECT_DOUBLE_EQ(json.at("kG").at("value"), 0.5);
  EXPECT_DOUBLE_EQ(json.at("offset").at("value"), 2.0);
  EXPECT_EQ(json.at("kA").at("unit"), "V s^2/rad");
  EXPECT_EQ(json.at("left_out").size(), 1u) << "of the constant torque";
}

TEST(Frc, HasStandardErrors) {
  Rig rig = rubbing_slide();
  AxisUncertainty& known = rig.uncertainty.emplace();
  known.quantities = {{quantity_index("M"), true, 0.01, 0.0, 1.0},
                      {quantity_index("K_f"), true, 0.02, 0.0, 1.0},
                      {quantity_index("B_a"), false, 2.0, 0.0, 1.0}};
  known.correlation = {1.0, 0.5, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 1.0};
  const Json json = gains(rig);
  const auto error = [&](const char* gain) {
    return json.at(gain).at("standard_error").get<double>();
  };
  // Relative errors of M / K_f, B_a / K_f and F_c / K_f, of which F_c was not fitted.
  EXPECT_NEAR(error("kA"), 0.5 * std::sqrt(1e-4 + 4e-4 - 2e-4), 1e-8);
  EXPECT_NEAR(error("kV"), 0.75 * std::hypot(2.0 / 30.0, 0.02), 1e-8);
  EXPECT_NEAR(error("kS"), 0.1 * 0.02, 1e-8);
  EXPECT_TRUE(json.at("left_out").empty());
}

TEST(Frc, RefusesWhatHasNoGain) {
  const auto refusal = [](const Rig& rig) -> std::string {
    try {
      export_axis(rig, ExportTarget::frc, "axis", "");
      return "";
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  Rig rig = slide();
  rig.model.structure.drive = Drive::motor_current;
  EXPECT_EQ(refusal(rig),
            "FRC cannot express this axis: its gains are in volts, and the command of drive: "
            "motor_current is not");
  rig = slide();
  add_effect<QuadraticDrag>(rig.model).c = 5.0;
  add_effect<StrokeSpring>(rig.model).k_s = 5.0;
  EXPECT_EQ(refusal(rig),
            "FRC cannot express this axis: none of its gains stands for quadratic_drag, "
            "stroke_spring; export an axis that was fitted without");
}

}  // namespace
}  // namespace axisfit
