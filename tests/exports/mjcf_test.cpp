#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "exports/export.h"
#include "sim/simulate.h"
#include "tests/apps/files.h"
#include "tests/exports/axes.h"
#if __has_include(<mujoco/mujoco.h>)
#include <mujoco/mujoco.h>
#endif

namespace axisfit {
namespace {

TEST(Mjcf, OfASlideHasItsNumbers) {
  Rig rig = rubbing_slide();
  add_effect<ConstantForce>(rig.model).F_0 = 3.0;
  add_effect<DriveLag>(rig.model).T_l = 0.01;
  const Export made = export_axis(rig, ExportTarget::mjcf, "slide", "Exported -- by a test");
  ASSERT_EQ(made.lost.size(), 1u);  // stops are not located
  EXPECT_EQ(made.files.front().first, "slide.xml");
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(only_file(made).c_str()));
  const auto body = document.child("mujoco").child("worldbody").child("body");
  EXPECT_EQ(body.child("inertial").attribute("mass").as_double(), 20.0);
  EXPECT_EQ(body.child("joint").attribute("damping").as_double(), 30.0);
  EXPECT_EQ(body.child("joint").attribute("frictionloss").as_double(), 4.0);
  const auto force = document.child("mujoco").child("actuator").child("general");
  EXPECT_EQ(std::string(force.attribute("biasprm").value()), "3 0 0");
  const auto drive = force.next_sibling();
  EXPECT_EQ(drive.attribute("gear").as_double(), 40.0);
  EXPECT_EQ(drive.attribute("dynprm").as_double(), 0.01);
}

#if __has_include(<mujoco/mujoco.h>)

/// What MuJoCo makes of a command at 1 kHz: positions.
std::vector<double> by_mujoco(const Export& made, const std::vector<double>& command) {
  TempFolder folder;
  const std::string path = folder.write("axis.xml", only_file(made));
  std::array<char, 1000> error{};
  mjModel* model = mj_loadXML(path.c_str(), nullptr, error.data(), error.size());
  EXPECT_NE(model, nullptr) << error.data();
  mjData* data = mj_makeData(model);
  std::vector<double> positions;
  for (const double u : command) {
    positions.push_back(data->qpos[0]);
    data->ctrl[mj_name2id(model, mjOBJ_ACTUATOR, "drive")] = u;
    mj_step(model, data);
  }
  mj_deleteData(data);
  mj_deleteModel(model);
  return positions;
}

/// By us, of what the target has.
std::vector<double> by_axisfit(const Export& made, const std::vector<double>& command) {
  std::vector<double> times(command.size()), positions;
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = 1e-3 * static_cast<double>(i);
  const auto read = [&](std::size_t, const Integrator<double>& axis) {
    positions.push_back(axis.state()[0]);
  };
  simulate<double>(made.carried.model, schedule_from_samples(times, command), times, read);
  return positions;
}

/// Largest difference between the two, per range of the motion.
double difference(const Rig& rig, double amplitude) {
  std::vector<double> command;
  constexpr std::array kLevels{1.0, -1.0, 0.05, -0.6, 0.0, 0.9, 0.04, -0.8};
  for (std::size_t i = 0; i < 4000; ++i)
    command.push_back(amplitude * kLevels[i / 500 % kLevels.size()]);
  const Export made = export_axis(rig, ExportTarget::mjcf, "axis", "By a test");
  const std::vector<double> theirs = by_mujoco(made, command), ours = by_axisfit(made, command);
  double most = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i)
    most = std::max(most, std::abs(ours[i] - theirs[i]));
  const auto [low, high] = std::ranges::minmax(ours);
  std::cout << "MuJoCo at 1 ms differs by " << most / (high - low) << " of the range\n";
  return most / (high - low);
}

TEST(Mjcf, MujocoMovesAsWeDo) {
  EXPECT_LT(difference(slide(), 2.0), 1e-6);
  EXPECT_LT(difference(rubbing_slide(), 2.0), 1e-3);
  Rig lagging = rubbing_slide();
  add_effect<DriveLag>(lagging.model).T_l = 0.01;
  add_effect<ConstantForce>(lagging.model).F_0 = 3.0;
  EXPECT_LT(difference(lagging, 2.0), 1e-3);
}

TEST(Mjcf, MujocoSwingsAsWeDo) {
  Rig rig = slide();
  rig.model.structure.joint = Joint::revolute;
  rig.model.axis.M = 0.02;
  rig.model.axis.B_a = 0.05;
  rig.model.axis.K_f = 1.0;
  PendulumGravity<double>& gravity = add_effect<PendulumGravity>(rig.model);
  gravity.G_s = 0.8;
  gravity.G_c = -0.3;
  EXPECT_LT(difference(rig, 0.5), 1e-5);
}

#endif

}  // namespace
}  // namespace axisfit
