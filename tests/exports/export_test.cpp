#include "exports/export.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <pugixml.hpp>

#include "io/config/axis_file.h"
#include "io/recording/mat_file.h"
#include "tests/apps/files.h"
#include "tests/sim/axes.h"
#if __has_include(<mujoco/mujoco.h>)
#include <mujoco/mujoco.h>
#endif

namespace axisfit {
namespace {

/// A slide that a current moves, 20 kg and 2 kg of its motor.
Rig slide() {
  Rig rig;
  rig.name = "slide";
  rig.model = driven_mass(20.0);
  rig.model.axis.K_f = 40.0;
  rig.model.axis.B_a = 30.0;
  return rig;
}

Rig rubbing_slide() {
  Rig rig = slide();
  add_effect<CoulombFriction>(rig.model).F_c = 4.0;
  return rig;
}

std::string only_file(const Export& made) {
  EXPECT_EQ(made.files.size(), 1u);
  return made.files.front().second;
}

TEST(Export, OfASlideHasItsNumbers) {
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

TEST(Export, SaysWhatIsLost) {
  Rig rig = rubbing_slide();
  rig.model.axis.T_d = 1e-3;
  add_effect<QuadraticDrag>(rig.model).c = 5.0;
  const Export mjcf = export_axis(rig, ExportTarget::mjcf, "a", "");
  ASSERT_EQ(mjcf.lost.size(), 3u);
  EXPECT_EQ(mjcf.lost[0].substr(0, 27), "quadratic_drag is left out:");
  EXPECT_EQ(mjcf.carried.model.axis.T_d, 0.0);
  EXPECT_NE(mjcf.files[0].second.find(mjcf.lost[1]), std::string::npos);
  add_effect<ConstantForce>(rig.model).F_0 = 3.0;
  EXPECT_EQ(export_axis(rig, ExportTarget::urdf, "a", "").lost.size(), 3u);
  rig.uncertainty.emplace();
  EXPECT_EQ(export_axis(rig, ExportTarget::urdf, "a", "").lost.back().substr(0, 19),
            "The standard errors");
  EXPECT_TRUE(export_axis(rig, ExportTarget::matlab, "a", "").lost.empty());
}

TEST(Export, RefusesAPreamplifier) {
  Rig rig;
  rig.model = paper_axis();
  for (const ExportTarget target : {ExportTarget::mjcf, ExportTarget::urdf}) try {
      export_axis(rig, target, "a", "");
      ADD_FAILURE();
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("cannot express this axis"), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("velocity_loop"), std::string::npos);
    }
  EXPECT_NO_THROW(export_axis(rig, ExportTarget::matlab, "a", ""));
}

TEST(Export, MatlabHasTheCovariance) {
  Rig rig = rubbing_slide();
  rig.name = "the arm's";
  AxisUncertainty& known = rig.uncertainty.emplace();
  known.quantities = {{find_quantity("M")->index, true, 0.0125, 0.025, 3.0},
                      {find_quantity("B_a")->index, false, 2.0, 0.0, 1.0}};
  known.correlation = {1.0, 0.5, 0.5, 1.0};
  const Export made = export_axis(rig, ExportTarget::matlab, "arm", "Exported by a test");
  ASSERT_EQ(made.files.size(), 2u);
  const std::string& text = made.files[0].second;
  EXPECT_NE(text.find("function axis = arm()\n"), std::string::npos);
  EXPECT_NE(text.find("axis.name = 'the arm''s';"), std::string::npos);
  EXPECT_NE(text.find("axis.parameters.M = 20;  % kg: arm mass\n"), std::string::npos) << text;
  EXPECT_NE(text.find("axis.effects.coulomb_friction.F_c = 4;"), std::string::npos);
  TempFolder folder;
  const Table table = read_mat(folder.write("arm.mat", made.files[1].second));
  const Column* values = table.find("values");
  ASSERT_NE(values, nullptr);
  EXPECT_EQ(values->values, (std::vector{20.0, 30.0}));
  EXPECT_NE(text.find("axis.fitted.covariance = ["), std::string::npos);
  // 0.25 and 0.5 kg; 2 N s/m; correlation 0.5.
  EXPECT_NE(text.find("covariance_of_machine = [0.3125, 0.25; 0.25, 4];"), std::string::npos)
      << text;
}

TEST(Export, MatlabFunctionsHaveNamesThatItTakes) {
  const auto name = [](const char* file) {
    return export_axis(slide(), ExportTarget::matlab, file, "").files[0].first;
  };
  EXPECT_EQ(name("fitted"), "fitted.m");
  EXPECT_EQ(name("x-axis 2"), "x_axis_2.m");
  EXPECT_EQ(name("2nd"), "axis_2nd.m");
}

TEST(Export, UrdfIsWhatTheCheckerTakes) {
  TempFolder folder;
  for (const bool turns : {false, true}) {
    Rig rig = rubbing_slide();
    if (turns) rig.model.structure.joint = Joint::revolute;
    const std::string path = folder.write(
        "axis.urdf", only_file(export_axis(rig, ExportTarget::urdf, "axis", "By a test")));
    if (std::system("command -v check_urdf > /dev/null") != 0)
      GTEST_SKIP() << "check_urdf (liburdfdom-tools) is not installed";
    EXPECT_EQ(std::system(("check_urdf " + path + " > /dev/null").c_str()), 0);
  }
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

TEST(Export, MujocoMovesAsWeDo) {
  EXPECT_LT(difference(slide(), 2.0), 1e-6);
  EXPECT_LT(difference(rubbing_slide(), 2.0), 1e-3);
  Rig lagging = rubbing_slide();
  add_effect<DriveLag>(lagging.model).T_l = 0.01;
  add_effect<ConstantForce>(lagging.model).F_0 = 3.0;
  EXPECT_LT(difference(lagging, 2.0), 1e-3);
}

TEST(Export, MujocoSwingsAsWeDo) {
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
