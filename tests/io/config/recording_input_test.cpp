#include "io/config/recording_input.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "tests/io/config/recording_reader.h"

namespace axisfit {
namespace {

std::vector<Column> columns() {
  Column time{"t", {}}, u{"u", {}}, duty{"duty", {}}, volts{"volts", {}};
  for (int i = 0; i < 20; ++i) {
    time.values.push_back(0.1 * i);
    u.values.push_back(i);
    duty.values.push_back(i % 2 == 0 ? 0.5 : -0.25);
    volts.values.push_back(48.0 - i);
  }
  return {time, u, duty, volts};
}

/// Reads what drives a mass, or the paper's axis, from a recording of 20 samples.
class InputTest : public RecordingReaderTest {
 protected:
  InputTest() : RecordingReaderTest(columns()) {
    rig_.model.structure = {Drive::force_source, Transmission::rigid, {}, Joint::prismatic};
  }

  std::optional<Series> read(const std::string& signals) {
    recording_ = {};
    return read_signals(signals, [&](const ConfigNode& node, SeriesReader& reader) {
      ConfigMap entries(node);
      return read_input(node, entries, rig_, reader, recording_);
    });
  }

  Rig rig_;
  Recording recording_;
};

TEST_F(InputTest, ACommandIsInTheUnitOfTheDrive) {
  const auto input = read("command: {column: u, unit: mV, sigma: 2 mV}");
  ASSERT_TRUE(input) << said();
  EXPECT_DOUBLE_EQ(input->values[3], 3e-3);
  EXPECT_DOUBLE_EQ(recording_.command_sigma, 2e-3);
  EXPECT_EQ(recording_.command_noise, NoiseSource::given);
  EXPECT_EQ(recording_.command.hold, Hold::zero_order);
  rig_.model.structure.drive = Drive::motor_current;
  read("command: {column: u, unit: V}");
  EXPECT_NE(said().find("'V' cannot be converted to 'A'"), std::string::npos) << said();
}

TEST_F(InputTest, AForceActsAsItIs) {
  const auto input = read("drive_force: {column: u, unit: kN}");
  ASSERT_TRUE(input) << said();
  EXPECT_EQ(input->values[3], 3000.0);
  EXPECT_EQ(recording_.command.hold, Hold::linear);
  ASSERT_EQ(recording_.overrides.size(), 1u);
  EXPECT_EQ(recording_.overrides[0], (std::pair<std::size_t, double>(quantity_index("K_f"), 1.0)));
}

TEST_F(InputTest, ADutyIsOfASupply) {
  rig_.model.structure.drive = Drive::motor_voltage;
  auto input = read("command: {column: duty, unit: \"1\", supply: 24 V}");
  ASSERT_TRUE(input) << said();
  EXPECT_EQ(input->values[2], 12.0);
  input = read("command: {column: duty, unit: \"1\", supply: {column: volts, unit: V}}");
  ASSERT_TRUE(input) << said();
  EXPECT_DOUBLE_EQ(input->values[2], 23.0);
  EXPECT_DOUBLE_EQ(input->values[3], -0.25 * 45.0);
  rig_.model.structure.drive = Drive::motor_current;
  read("command: {column: duty, unit: \"1\", supply: 24 V}");
  EXPECT_EQ(said(), "a duty of a supply makes a voltage: the drive must be one that takes V\n");
}

TEST_F(InputTest, AReferenceIsFollowedByTheController) {
  auto input = read("position_reference: {column: u, unit: mm}");
  ASSERT_TRUE(input) << said();
  EXPECT_EQ(recording_.command.meaning, Meaning::reference);
  EXPECT_EQ(input->values[3], 3e-3);
  rig_.model.structure.drive = Drive::velocity_loop;
  EXPECT_FALSE(read("position_reference: {column: u, unit: mm}"));
  EXPECT_EQ(said(),
            "to compute the command of a position_reference the controller reads the encoder: name "
            "its column under position, or say 'loop: simulated'\n");
  input = read("position_reference: {column: u, unit: mm, loop: simulated}");
  ASSERT_TRUE(input) << said();
  EXPECT_EQ(recording_.command.meaning, Meaning::reference);
}

// As drives do before their controller sees it.
TEST_F(InputTest, AReferenceMayBeDelayedAndSmoothed) {
  const auto plain = read("position_reference: {column: u, unit: mm}");
  ASSERT_TRUE(plain) << said();
  const auto late = read("position_reference: {column: u, unit: mm, delay: 2 ms}");
  ASSERT_TRUE(late) << said();
  ASSERT_EQ(late->times.size(), plain->times.size() + 1);
  EXPECT_EQ(late->times[0], plain->times[0]);
  EXPECT_EQ(late->values[0], plain->values[0]);
  for (std::size_t i = 0; i < plain->times.size(); ++i) {
    EXPECT_DOUBLE_EQ(late->times[i + 1], plain->times[i] + 2e-3);
    EXPECT_EQ(late->values[i + 1], plain->values[i]);
  }
  const auto smooth =
      read("position_reference: {column: u, unit: mm, filter: {moving_average: 2}}");
  ASSERT_TRUE(smooth) << said();
  EXPECT_EQ(smooth->values[0], plain->values[0]);
  EXPECT_DOUBLE_EQ(smooth->values[3], 0.5 * (plain->values[2] + plain->values[3]));
  const auto logged = read("position_reference: {column: u, unit: mm, offset: -1 ms}");
  ASSERT_TRUE(logged) << said();
  EXPECT_TRUE(logged->own_clock);
  EXPECT_DOUBLE_EQ(logged->times[3], plain->times[3] - 1e-3);
  read("position_reference: {column: u, unit: mm, delay: -1 ms}");
  EXPECT_NE(said().find("delay must lie between 0 s and 1 s"), std::string::npos);
}

TEST_F(InputTest, AReferenceIsThereAtEverySample) {
  sources_.tables["a.csv"].columns[1].values[7] = NAN;
  EXPECT_FALSE(read("position_reference: {column: u, unit: mm}"));
  EXPECT_EQ(said(),
            "the controller needs the reference at every sample, and some are missing: trim the "
            "recording or fill the gaps\n");
}

TEST_F(InputTest, IsOneAndOnlyOne) {
  const std::string command = "command: {column: u, unit: V}",
                    force = "drive_force: {column: u, unit: N}",
                    reference = "position_reference: {column: u, unit: m}";
  read("velocity: {column: u, unit: m/s}");
  EXPECT_EQ(said(),
            "the axis is driven by a command or a drive_force: name one of them, or the "
            "position_reference that its controller follows\n");
  EXPECT_FALSE(read(command + ", " + force));
  EXPECT_EQ(said(), "give either the command or the drive force, not both: each drives the axis\n");
  read(command + ", " + reference);
  EXPECT_EQ(said(), "the recorded command drives the axis: remove position_reference\n");
  read(force + ", " + reference);
  EXPECT_EQ(said(), "the recorded force drives the axis: remove position_reference\n");
}

}  // namespace
}  // namespace axisfit
