#include "io/recording/sysid_file.h"

#include <cmath>

#include "tests/io/recording/kind_fixture.h"

namespace axisfit {
namespace {

class SysIdTest : public KindTest {
 protected:
  /// The message for a test of a file.
  std::string error_of(const std::string& contents, const std::string& test) const {
    folder_.write("arm.json", contents);
    try {
      RecordingFile(folder_.path("arm.json" + test));
    } catch (const RecordingError& caught) {
      return folder_.without_path(caught.what());
    }
    return "no error";
  }

  RecordingFile test_of(const std::string& contents, const std::string& test) const {
    return RecordingFile(folder_.write("arm.json", contents) + test);
  }
};

std::string file(const std::string& units, double factor = 1.0) {
  return "{\"fast-backward\": [[5.0, -7.0, 0.5, -1.0]],\n\"slow-forward\": "
         "[[1.0, 0.5, 0.25, 2.0],\n[1.005, 0.6, 0.5, null]], \"slow-backward\": [],\n"
         "\"sysid\": true, \"test\": \"Elevator\", \"units\": \"" +
         units + "\", \"unitsPerRotation\": " + std::to_string(factor) + "}\n";
}

TEST_F(SysIdTest, ReadsTheTestThatIsNamed) {
  const RecordingFile slow = test_of(file("Meters", 2.0), "#slow-forward");
  EXPECT_EQ(column(slow, "time").values, (Values{1.0, 1.005}));
  EXPECT_EQ(column(slow, "time").unit, "s");
  EXPECT_EQ(column(slow, "motor voltage").values, (Values{0.5, 0.6}));
  EXPECT_EQ(column(slow, "motor voltage").unit, "V");
  EXPECT_EQ(column(slow, "position").values, (Values{0.5, 1.0}));
  EXPECT_EQ(column(slow, "position").unit, "m");
  EXPECT_EQ(column(slow, "velocity").values[0], 4.0);
  EXPECT_TRUE(std::isnan(column(slow, "velocity").values[1]));
  EXPECT_EQ(column(test_of(file("Meters"), "#fast-backward"), "time").values, Values{5.0});
}

TEST_F(SysIdTest, UnitsAreThoseOfTheFile) {
  const auto read = [&](const char* unit) { return test_of(file(unit), "#slow-forward"); };
  EXPECT_DOUBLE_EQ(column(read("Feet"), "position").values[1], 0.1524);
  EXPECT_DOUBLE_EQ(column(read("Inches"), "velocity").values[0], 0.0508);
  EXPECT_EQ(column(read("Inches"), "velocity").unit, "m/s");
  EXPECT_EQ(column(read("Degrees"), "position").unit, "deg");
  EXPECT_EQ(column(read("Radians"), "velocity").unit, "rad/s");
  EXPECT_EQ(column(read("Rotations"), "position").values[0], 0.25);
  EXPECT_EQ(column(read("Rotations"), "velocity").values[0], 120.0);
  EXPECT_EQ(column(read("Rotations"), "velocity").unit, "rpm");
}

TEST_F(SysIdTest, SaysWhichTestsThereAre) {
  EXPECT_EQ(error_of(file("Meters"), ""),
            "arm.json: holds the tests slow-forward, fast-backward; name one behind the file, as "
            "arm.json#slow-forward");
  EXPECT_EQ(
      error_of(file("Meters"), "#slow-backward"),
      "arm.json: has no test 'slow-backward', but the tests slow-forward, fast-backward; name "
      "one behind the file, as arm.json#slow-forward");
  EXPECT_EQ(error_of("t,x\n0,1\n", "#slow-forward"),
            "arm.json: holds one recording: leave '#slow-forward' out of its name");
}

TEST_F(SysIdTest, TheOnlyTestNeedsNoName) {
  const std::string one =
      "{\"sysid\": true, \"units\": \"Radians\", \"dynamic-forward\": [[0, 1, 2, 3]]}";
  EXPECT_EQ(column(read(one), "velocity").values, Values{3});
}

TEST_F(SysIdTest, ADrivetrainHasTwoSides) {
  const RecordingFile both = read(
      "{\"slow-forward\": [[0, 1, 2, 3, 4, 5, 6, 7, 8]], \"test\": \"Drivetrain\", "
      "\"units\": \"Meters\", \"unitsPerRotation\": 0.5}");
  EXPECT_EQ(column(both, "left motor voltage").values, Values{1});
  EXPECT_EQ(column(both, "right position").values, Values{2});
  EXPECT_EQ(column(both, "left velocity").values, Values{2.5});
  EXPECT_EQ(column(both, "gyro angle").values, Values{7});
  EXPECT_EQ(column(both, "gyro angle").unit, "");
}

TEST_F(SysIdTest, RefusesWhatSysIdDoesNotWrite) {
  EXPECT_EQ(error("{\"slow-forward\": [[0, 1, 2]]}"),
            "run.dat: slow-forward has rows of 3 values, and SysId writes 4, or 9 of a drivetrain; "
            "convert files of frc-characterization by SysId");
  EXPECT_EQ(error("{\"slow-forward\": [[0, 1, 2, 3], [0, 1]], \"units\": \"Meters\"}"),
            "run.dat: row 2 of slow-forward has not 4 numbers, as the first has; copy it again");
  EXPECT_EQ(error("{\"slow-forward\": [[0, 1, 2, \"x\"]], \"units\": \"Meters\"}"),
            "run.dat: row 1 of slow-forward has something that is no number; copy it again");
  EXPECT_EQ(error(file("Furlongs")).find("run.dat: holds the tests"), 0u);
  EXPECT_EQ(error("{\"slow-forward\": [[0, 1, 2, 3]], \"units\": \"Furlongs\"}"),
            "run.dat: has the unit 'Furlongs', which SysId does not know; open it in SysId, choose "
            "a unit there and save it again");
  EXPECT_EQ(error("{\"slow-forward\": []}"),
            "run.dat: is a file of SysId without a test that has rows");
  EXPECT_EQ(error("{\"slow-forward\": [[0, 1,"),
            "run.dat: is a file of SysId that is cut off or damaged; copy it again");
  EXPECT_EQ(error("{\"slow-forward\": " + std::string(100000, '[')),
            "run.dat: is no file of SysId: it is too nested");
}

}  // namespace
}  // namespace axisfit
