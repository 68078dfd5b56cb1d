// Which kind of axis a recording is taken for.
#include "init/machine_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "init/starter_axis.h"
#include "io/config/axis_file.h"
#include "io/config/job_file.h"
#include "sim/rig.h"
#include "tests/apps/files.h"

namespace axisfit {
namespace {

class MachineChoiceTest : public ::testing::Test {
 protected:
  /// What an axis records in a motion of 2 s, under the names that a drive gives.
  std::string record(const std::string& axis, const Motion& motion) {
    Diagnostics diagnostics;
    const auto rig = read_axis_file(folder_.write("true.yaml", axis), diagnostics);
    diagnostics.throw_if_any();
    RecordingOptions options;
    options.duration = 2.0;
    options.signals = {Signal::position};
    Table table{"", axisfit::record(*rig, motion, options), {}};
    table.columns[1].name = "current_A";
    return folder_.write("run.csv", table);
  }

  /// With the job written where it is meant to go.
  MachineChoice choose(const std::string& recording) {
    MachineChoice choice = choose_machine({.recordings = {recording}, .folder = folder_.path()});
    for (const auto& [name, contents] : choice.job.files) folder_.write(name, contents);
    return choice;
  }
  static const TriedAxis& tried(const MachineChoice& choice, const std::string& name) {
    return *std::ranges::find(choice.tried, name, &TriedAxis::name);
  }

  TempFolder folder_;
};

constexpr const char* kSlide = R"(drive: motor_current
transmission: rigid
parameters: {K_f: 60 N/A, M: 12 kg, B_a: 40 N s/m}
effects: {coulomb_friction: {F_c: 15 N}}
controller: {limit: 100 A, counts_per_revolution: 6283185}
)";

TEST_F(MachineChoiceTest, OneMassIsTakenWhereItExplainsTheForces) {
  const MachineChoice choice =
      choose(record(kSlide, LevelsMotion{{2, -2, 1, -1.5, 0.7, -1, 1.5, -2}, 0.25}));
  EXPECT_TRUE(choice.tried.empty()) << "nothing else was fitted";
  EXPECT_TRUE(choice.is_explained);
  ASSERT_TRUE(choice.job.look);
  EXPECT_LT(choice.job.look->unexplained, 0.02);
  const JobFile file = read_job_file(folder_.path("job.yaml"));
  EXPECT_EQ(file.job.model.structure.transmission, Transmission::rigid);
}

constexpr const char* kGeared = R"(drive: motor_current
transmission: backlash
parameters: {K_f: 60 N/A, r_g: 5 mm, J_m: 0.5 kg cm^2, B_m: 0 N m s/rad, H: 0.08 mm, k_g: 1.5 MN/m,
  b_g: 400 N s/m, M: 35 kg, B_a: 90 N s/m}
effects: {coulomb_friction: {F_c: 25 N}}
controller: {limit: 100 A, counts_per_revolution: 31416}
)";

// Its gap is seen by the motor's encoder alone.
TEST_F(MachineChoiceTest, AGapIsSeen) {
  const MachineChoice choice = choose(record(kGeared, SineMotion{2.0, 1.0, 15.0, 0.0}));
  EXPECT_EQ(choice.tried.front().name, "rack");
  ASSERT_TRUE(choice.tried.front().error);
  EXPECT_LT(3.0 * *choice.tried.front().error, tried(choice, "mass").error.value_or(1e9));
  // The example's values are said to be guesses.
  const JobFile file = read_job_file(folder_.path("job.yaml"));
  EXPECT_EQ(std::ranges::count(file.job.guessed, quantity_index("K_f")), 1);
  EXPECT_EQ(std::ranges::count(file.job.guessed, quantity_index("J_m")), 1);
  EXPECT_EQ(std::ranges::count(file.job.guessed, quantity_index("M")), 0);
}

// All that tells it is that the position follows a goal.
TEST_F(MachineChoiceTest, AServoIsSeenWithoutUnits) {
  const auto servo = std::ranges::find(machine_axes(), "hobby-servo", &MachineAxis::name);
  Diagnostics diagnostics;
  const auto rig =
      read_axis(*ConfigNode::parse(std::string(servo->text), "", diagnostics), diagnostics);
  diagnostics.throw_if_any();
  RecordingOptions options;
  options.duration = 3.0;
  options.signals = {Signal::position};
  Table table{"", axisfit::record(*rig, LevelsMotion{{1.0, -0.5, 0.8, -1.0}, 0.7}, options), {}};
  table.columns[0].name = "timestamp";
  table.columns[1].name = "goal_position";
  table.columns[2].name = "position";
  table.columns.push_back({"load", {}});
  for (std::size_t i = 0; i < table.columns[1].values.size(); ++i)
    table.columns[3].values.push_back(
        std::round(100.0 * (table.columns[1].values[i] - table.columns[2].values[i])));
  const MachineChoice choice = choose(folder_.write("run.csv", table));
  EXPECT_EQ(choice.tried.front().name, "hobby-servo");
  EXPECT_NE(folder_.read("job.yaml").find("taken as rad"), std::string::npos);
  // Its gain and the weight of its load are those of an example.
  const std::vector<std::size_t> guessed = read_job_file(folder_.path("job.yaml")).job.guessed;
  for (const char* name : {"controller.gain", "pendulum_gravity.G_s"})
    EXPECT_EQ(std::ranges::count(guessed, quantity_index(name)), 1) << name;
}

TEST_F(MachineChoiceTest, ColumnsSayWhatIsTried) {
  const auto machines = [&](const std::string& header) {
    std::string text = header + "\n";
    for (int i = 0; i < 200; ++i) {
      const double t = 0.002 * i, wave = std::sin(9.0 * t);
      const std::array values{t, 2.0 * wave, 0.3 * std::cos(9.0 * t), std::round(9.0 * wave)};
      const auto columns = static_cast<std::size_t>(1 + std::ranges::count(header, ','));
      text += fmt::format("{}\n", fmt::join(std::span(values).first(columns), ","));
    }
    return machines_for({.recordings = {folder_.write("run.csv", text)}});
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(machines("time_s,current_A,position_m"),
            (Names{"rack", "screw", "belt", "linear-motor"}));
  EXPECT_EQ(machines("time_s,current_A,angle_rad"), Names{"turntable"});
  EXPECT_EQ(machines("time_s,torque [%],angle_rad"), Names{"geared-joint"});
  EXPECT_EQ(machines("time_s,goal position [rad],position [rad]"), Names{"hobby-servo"});
  EXPECT_EQ(machines("time_s,force_N,position_m"), Names{});
  // Without units, both joints are tried; what a servo reports beside its goal need not drive it.
  EXPECT_EQ(machines("time_s,current_A,position"),
            (Names{"rack", "screw", "belt", "linear-motor", "turntable"}));
  EXPECT_EQ(machines("timestamp,goal_position,position,load"), Names{"hobby-servo"});
  EXPECT_EQ(machines("timestamp,goal_position [mm],position [mm],load"), Names{});
}

}  // namespace
}  // namespace axisfit
