#include "exports/rigid_axis.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "tests/exports/axes.h"

namespace axisfit {
namespace {

TEST(RigidAxis, FeelsTheMotorThroughItsRadius) {
  Rig rig = slide();
  Axis<double>& a = rig.model.axis;
  a.r_g = 0.02;
  a.J_m = 0.0008;
  a.B_m = 0.004;
  const RigidAxis current = reduced_to(rig, {}, "it").axis;
  EXPECT_EQ(current.arm, 20.0);
  EXPECT_DOUBLE_EQ(current.armature, 2.0);  // J_m / r_g^2
  EXPECT_DOUBLE_EQ(current.damping, 30.0 + 10.0);
  EXPECT_EQ(current.gain, 40.0);
  // At a voltage its back EMF brakes, too: K_m^2 / (R r_g^2).
  rig.model.structure.drive = Drive::motor_voltage;
  a.K_m = 0.3;
  a.R = 1.5;
  const RigidAxis voltage = reduced_to(rig, {}, "it").axis;
  EXPECT_DOUBLE_EQ(voltage.damping, 30.0 + 10.0 + 150.0);
  EXPECT_DOUBLE_EQ(voltage.gain, 10.0);  // K_m / (R r_g)
}

TEST(RigidAxis, HasTheEffectsThatTheTargetHas) {
  Rig rig = rubbing_slide();
  add_effect<AddedMass>(rig.model).dM = 1.5;
  add_effect<CommandOffset>(rig.model).U_0 = 0.25;
  add_effect<ConstantForce>(rig.model).F_0 = 3.0;
  const Reduced all =
      reduced_to(rig, {"coulomb_friction", "added_mass", "command_offset", "constant_force"}, "it");
  EXPECT_EQ(all.axis.arm, 21.5);
  EXPECT_EQ(all.axis.friction, 4.0);
  EXPECT_DOUBLE_EQ(all.axis.force, 3.0 + 0.25 * 40.0);
  EXPECT_TRUE(all.lost.empty());
  const Reduced some = reduced_to(rig, {"coulomb_friction"}, "it");
  EXPECT_EQ(some.axis.arm, 20.0);
  EXPECT_EQ(some.axis.force, 0.0);
  ASSERT_EQ(some.lost.size(), 3u);
  for (const std::string& sentence : some.lost)
    EXPECT_NE(sentence.find(" is left out: "), std::string::npos) << sentence;
  EXPECT_EQ(some.rig.model.structure.effects.count(), 1u) << "the same for our own simulation";
}

TEST(RigidAxis, SaysWhatIsLost) {
  Rig rig = slide();
  rig.model.structure.transmission = Transmission::backlash;
  rig.model.axis.F_s = 2.0;
  rig.model.axis.T_d = 1e-3;
  const Reduced reduced = reduced_to(rig, {}, "it");
  EXPECT_EQ(reduced.lost,
            (std::vector<std::string>{
                "The backlash and the stiffness of the gear are left out: arm and motor are one "
                "mass.",
                "The static friction beyond the Coulomb friction (F_s) is left out.",
                "The dead time of the command (T_d) is left out."}));
  EXPECT_EQ(reduced.rig.model.structure.transmission, Transmission::rigid);
  EXPECT_EQ(reduced.rig.model.axis.F_s, 0.0);
  EXPECT_EQ(reduced.rig.model.axis.T_d, 0.0);
}

TEST(RigidAxis, RefusesAPreamplifier) {
  Rig rig = slide();
  rig.model.structure.drive = Drive::current_source;
  try {
    reduced_to(rig, {}, "Anything");
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("Anything cannot express this axis:"))
        << error.what();
  }
}

}  // namespace
}  // namespace axisfit
