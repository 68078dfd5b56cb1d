#include "init/starter_axis.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "io/config/axis_file.h"
#include "tests/init/made_job.h"

namespace axisfit {
namespace {

using StarterAxisTest = InitJobTest;

// Each machine of the list is an axis file that is valid, and the job begins with it.
TEST_F(StarterAxisTest, AMachineIsTakenByItsName) {
  for (const MachineAxis& machine : machine_axes()) {
    Diagnostics diagnostics;
    const auto rig = read_axis(
        *ConfigNode::parse(std::string(machine.text), "axis.yaml", diagnostics), diagnostics);
    EXPECT_TRUE(rig && diagnostics.empty()) << machine.name;
  }
  folder_.write(
      "a.csv",
      renamed(driven(),
              {{"t_s", 1.0}, {"iq [A]", 1.0}, {"pos [mm]", 1e3}, {"v_mps", 1.0}, {"a_mps2", 1.0}}));
  const auto of_machine = [&](const std::string& machine) {
    return initial_job({.recordings = {folder_.path("a.csv")},
                        .folder = folder_.path(),
                        .axis = machine,
                        .is_machine = true});
  };
  const InitialJob made = of_machine("linear-motor");
  for (const auto& [name, contents] : made.files) folder_.write(name, contents);
  EXPECT_NE(folder_.read("axis.yaml").find("name: slide with a linear motor"), std::string::npos);
  const JobFile file = read();
  EXPECT_EQ(file.job.model.structure.drive, Drive::motor_current);
  expect_the_driven_mass(fitted(file), 1.0);  // both have 60 N/A
  EXPECT_THROW(of_machine("loom"), std::runtime_error);
}

TEST_F(StarterAxisTest, ALargeCurrentLeavesNoRoomBeyondTheBounds) {
  folder_.write(
      "a.csv",
      renamed(driven(),
              {{"t_s", 1.0}, {"current_a", 20.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}}));
  make({"a.csv"});
  const std::string bounds = "coulomb_friction.F_c: {bounds: [0 N, 100000 N]}";
  EXPECT_NE(folder_.read("job.yaml").find(bounds), std::string::npos) << folder_.read("job.yaml");
  expect_the_driven_mass(fitted(read()), 20.0 / 60.0);
}

TEST_F(StarterAxisTest, AKnownGainIsAllThatACurrentNeeds) {
  Table table = driven();
  table.columns[1].name = "i_A";
  folder_.write("a.csv", table);
  const InitialJob made = make({"a.csv"}, {}, 60.0);
  EXPECT_TRUE(made.guesses.empty()) << made.guesses.front();
  const JobFile file = read();
  EXPECT_EQ(file.job.model.axis.K_f, 60.0);
  EXPECT_TRUE(file.job.guessed.empty());
  EXPECT_NEAR(file.job.model.axis.M, 12.0, 2.0);
  expect_the_driven_mass(fitted(file), 1.0);
  table.columns[1].name = "force_N";
  folder_.write("a.csv", table);
  EXPECT_THROW(make({"a.csv"}, {}, 60.0), std::runtime_error);
}

// Without the rating, a torque in per cent is no force: K_f, the rated force, is a guess.
TEST_F(StarterAxisTest, APartOfARatingNeedsTheGain) {
  folder_.write("a.csv", renamed(driven(), {{"t_s", 1.0},
                                            {"TorqueActual [%]", 1.0},
                                            {"Lage-Ist [mm]", 1e3},
                                            {"v_mps", 1.0},
                                            {"a_mps2", 1.0}}));
  const InitialJob made = make({"a.csv"});
  ASSERT_EQ(made.guesses.size(), 1u);
  EXPECT_TRUE(made.guesses[0].starts_with("the drive gain, K_f in axis.yaml")) << made.guesses[0];
  EXPECT_NE(folder_.read("job.yaml").find("command: {column: \"TorqueActual [%]\", unit: \"%\"}"),
            std::string::npos)
      << folder_.read("job.yaml");
  const JobFile file = read();
  EXPECT_EQ(file.job.model.structure.drive, Drive::rated_force);
  EXPECT_EQ(file.job.guessed, std::vector{quantity_index("K_f")});
  expect_the_driven_mass(fitted(file), 1.0 / 60.0);
}

}  // namespace
}  // namespace axisfit
