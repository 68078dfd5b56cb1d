#include "io/config/machine_file.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/apps/files.h"

namespace axisfit {
namespace {

// Lines count: the messages below name them.
constexpr const char* kMachine = R"(axes:
  x:
    axis: x.yaml
    motion: step.yaml
    channels: {y_acceleration: y.acceleration}
    effects: {channel_force: {y_acceleration: -2 N/(m/s^2)}}
  y:
    axis: y.yaml
    motion: long.yaml
    channels: {slide: x.position}
)";

class MachineFileTest : public ::testing::Test {
 protected:
  MachineFileTest() {
    const std::string mass =
        "drive: force_source\ntransmission: rigid\n"
        "parameters: {K_f: 2 N/V, M: 4 kg, B_a: 8 N s/m}\n";
    folder_.write("x.yaml", mass);
    folder_.write("y.yaml", mass +
                                "channels: {oil: {unit: degC, zero: 25 degC}, slide: {unit: mm}}\n"
                                "effects: {channel_friction: {slide: 1 N/m}}\n");
    folder_.write("step.yaml", "type: step\nduration: 1 s\nlevel: 2 V\n");
    folder_.write("long.yaml", "type: step\nduration: 2 s\nlevel: 2 V\n");
  }
  MachineFile read(const std::string& text = kMachine) {
    return read_machine_file(folder_.write("machine.yaml", text));
  }
  std::string errors_with(const std::string& from, const std::string& to) {
    try {
      read(replaced(kMachine, from, to));
    } catch (const ConfigError& error) {
      return folder_.without_path(error.what());
    }
    return "";
  }

  TempFolder folder_;
};

TEST_F(MachineFileTest, ConnectsItsAxes) {
  const MachineFile file = read();
  ASSERT_EQ(file.axes.size(), 2u);
  EXPECT_EQ(file.duration, 2.0);
  EXPECT_EQ(file.files.size(), 5u);
  const CoupledAxis &x = file.axes[0], &y = file.axes[1];
  EXPECT_EQ(*x.rig.model.structure.channels, (ChannelList{{"y_acceleration", "m/s^2", 0.0}}));
  ASSERT_EQ(x.sources.size(), 1u);
  EXPECT_EQ(x.sources[0].axis, 1u);
  EXPECT_EQ(x.sources[0].what.of, Motional::Of::position);
  EXPECT_EQ(x.sources[0].what.derivative, 2);
  EXPECT_EQ(std::get<ChannelForce<double>>(x.rig.model.effects).k[0], -2.0);
  // What the axis file declares has its unit; what nothing feeds stays at its zero.
  ASSERT_EQ(y.sources.size(), 2u);
  EXPECT_FALSE(y.sources[0].axis.has_value());
  EXPECT_EQ(y.sources[1].axis, 0u);
  EXPECT_DOUBLE_EQ(y.sources[1].per_si, 1e3);
}

TEST_F(MachineFileTest, ReadsTheShippedRobot) {
  const MachineFile file = read_machine_file(AXISFIT_CONFIGS "/machines/robot.yaml");
  ASSERT_EQ(file.axes.size(), 4u);
  EXPECT_EQ(file.axes[1].name, "y");
  EXPECT_TRUE(is_machine_file(AXISFIT_CONFIGS "/machines/robot.yaml"));
  EXPECT_FALSE(is_machine_file(AXISFIT_CONFIGS "/axes/x.yaml"));
  EXPECT_FALSE(is_machine_file(folder_.path("none.yaml")));
}

TEST_F(MachineFileTest, MistakesAreToldWithTheirPlace) {
  const auto expect = [&](const char* from, const char* to, const char* message) {
    const std::string found = errors_with(from, to);
    EXPECT_NE(found.find(message), std::string::npos) << found;
  };
  expect("y.acceleration", "z.acceleration", "machine.yaml:5:32: 'z.acceleration' is no motion of");
  expect("y.acceleration", "x.acceleration", "'x.acceleration' is no motion of another axis");
  expect("y.acceleration", "y.force", "write AXIS.position");
  expect("y.acceleration", "y.sine", "'y.sine' needs a joint that turns, and y slides");
  expect("x.position", "x.velocity", "the channel 'slide' is in mm, and x.velocity in m/s");
  expect("N/(m/s^2)", "N/m", "6:47: y_acceleration: 'N/m' cannot be converted");
  expect("    motion: step.yaml\n", "", "key 'motion' is missing in x");
  expect("  x:", "  ../x:", "machine.yaml:2:3: '../x' cannot be the name of an axis");
  expect("x.yaml", "none.yaml", "none.yaml");
  expect("step.yaml", "none.yaml", "none.yaml");
  EXPECT_NE(errors_with(std::string(kMachine).substr(std::string(kMachine).find("  y:")), "")
                .find("a machine has at least two axes"),
            std::string::npos);
}

}  // namespace
}  // namespace axisfit
