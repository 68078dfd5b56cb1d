#include "io/config/motion_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "io/config/axis_file.h"
#include "io/config/config.h"
#include "tests/apps/files.h"

namespace axisfit {
namespace {

Rig shipped_axis(const std::string& name) {
  Diagnostics diagnostics;
  const auto rig = read_axis_file(AXISFIT_CONFIGS "/axes/" + name + ".yaml", diagnostics);
  diagnostics.throw_if_any();
  return *rig;
}

class MotionFileTest : public ::testing::Test {
 protected:
  MotionFile read(const std::string& text) {
    return read_motion_file(folder_.write("motion.yaml", text), rig_);
  }
  std::string errors(const std::string& text) {
    try {
      read(text);
    } catch (const ConfigError& error) {
      return folder_.without_path(error.what());
    }
    return "";
  }

  TempFolder folder_;
  Rig rig_ = shipped_axis("x");
};

TEST_F(MotionFileTest, EveryShippedMotionReadsForTheXAxis) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(AXISFIT_CONFIGS "/motions")) {
    SCOPED_TRACE(entry.path().filename().string());
    MotionFile file;
    ASSERT_NO_THROW(file = read_motion_file(entry.path().string(), rig_));
    EXPECT_GE(file.duration, 1.0);
    const Schedule schedule =
        schedule_of(file.motion, file.duration, rig_.model.controller.timing.period);
    EXPECT_EQ(schedule.times.empty(), std::holds_alternative<MoveMotion>(file.motion));
    ++count;
  }
  EXPECT_GE(count, 7);
}

TEST_F(MotionFileTest, ReadsEveryTypeInSiUnits) {
  const auto step = read("type: step\nlevel: -250 mV\nstart: 20 ms\nduration: 1 min\n");
  EXPECT_EQ(step.duration, 60.0);
  EXPECT_DOUBLE_EQ(std::get<StepMotion>(step.motion).level, -0.25);
  EXPECT_DOUBLE_EQ(std::get<StepMotion>(step.motion).start, 0.02);

  const auto levels = read("type: levels\nlevels: [1 V, -10 V]\nhold: 5 ms\nduration: 1 s\n");
  EXPECT_EQ(std::get<LevelsMotion>(levels.motion).levels, (std::vector<double>{1.0, -10.0}));
  EXPECT_DOUBLE_EQ(std::get<LevelsMotion>(levels.motion).hold, 0.005);

  const auto sine =
      read("type: sine\namplitude: 4 V\nfrequency: 2 Hz\noffset: -6 V\nduration: 1 s\n");
  EXPECT_EQ(std::get<SineMotion>(sine.motion).from, 2.0);
  EXPECT_EQ(std::get<SineMotion>(sine.motion).to, 2.0);
  EXPECT_EQ(std::get<SineMotion>(sine.motion).amplitude, 4.0);
  EXPECT_EQ(std::get<SineMotion>(sine.motion).offset, -6.0);

  const auto chirp = read("type: chirp\namplitude: 4 V\nfrom: 0 Hz\nto: 1 kHz\nduration: 1 s\n");
  EXPECT_EQ(std::get<SineMotion>(chirp.motion).from, 0.0);
  EXPECT_EQ(std::get<SineMotion>(chirp.motion).to, 1000.0);
  EXPECT_EQ(std::get<SineMotion>(chirp.motion).offset, 0.0);

  const auto prbs = read("type: prbs\namplitude: 4 V\nbit: 30 ms\nseed: 9\nduration: 1 s\n");
  EXPECT_DOUBLE_EQ(std::get<PrbsMotion>(prbs.motion).bit, 0.03);
  EXPECT_EQ(std::get<PrbsMotion>(prbs.motion).seed, 9u);

  const auto move =
      read("type: move\ndistance: -5 cm\nspeed: 1 m/s\nacceleration: 200 cm/s^2\nduration: 1 s\n");
  EXPECT_DOUBLE_EQ(std::get<MoveMotion>(move.motion).distance, -0.05);
  EXPECT_DOUBLE_EQ(std::get<MoveMotion>(move.motion).acceleration, 2.0);
}

constexpr const char* kRecorded = R"(type: recorded
file: rec.csv
time: {column: t, unit: ms}
command: {column: u, unit: V, sign: -1, factor: 2}
duration: 1 s
)";

TEST_F(MotionFileTest, ReadsARecordedCommand) {
  folder_.write("rec.csv", "t,u\n0,1\n10,1\n25,-3\n");
  const Schedule schedule = std::get<RecordedMotion>(read(kRecorded).motion).schedule;
  EXPECT_EQ(schedule.times, (std::vector<double>{0.0, 0.025}));
  EXPECT_EQ(schedule.values, (std::vector<double>{-2.0, 6.0}));
}

TEST_F(MotionFileTest, ARecordedCommandMustBeOneThatTheControllerCanWrite) {
  folder_.write("rec.csv", "t,u\n0,1\n10,5.5\n");
  EXPECT_EQ(
      errors(kRecorded),
      "motion.yaml:4:10: rec.csv:3: a command of -11 V exceeds the controller's limit of 10 V");
  folder_.write("rec.csv", "t,u\n0,1\n10,2\n5,3\n");
  EXPECT_EQ(errors(kRecorded),
            "motion.yaml:3:7: rec.csv:4: time 0.005 s does not increase from 0.01 s: samples must "
            "be in order of time, without repeats");
  folder_.write("rec.csv", "t,v\n0,1\n");
  EXPECT_EQ(errors(kRecorded), "motion.yaml:4:19: no column 'u' in rec.csv; it has t, v");
  EXPECT_EQ(
      errors(replaced(kRecorded, "rec.csv", "none.csv")),
      "motion.yaml:2:7: none.csv: cannot be opened (No such file or directory); check the path "
      "and the permissions");
}

TEST_F(MotionFileTest, VoltagesBeyondTheLimitAreRefused) {
  EXPECT_EQ(errors("type: step\nlevel: 10.5 V\nduration: 1 s\n"),
            "motion.yaml:2:8: level must lie between -10 V and 10 V, not 10.5 V");
  EXPECT_EQ(errors("type: levels\nlevels: [1 V, 20 V, -11 V]\nhold: 1 s\nduration: 1 s\n"),
            "motion.yaml:2:15: entry 2 of levels must lie between -10 V and 10 V, not 20 V\n"
            "motion.yaml:2:21: entry 3 of levels must lie between -10 V and 10 V, not -11 V");
  EXPECT_EQ(errors("type: levels\nlevels: [1 A, 2 A, -1 A]\nhold: 1 s\nduration: 1 s\n"),
            "motion.yaml:2:10: entry 1 of levels: 'A' cannot be converted to 'V'; use for example "
            "'V'");
  EXPECT_EQ(errors("type: sine\namplitude: 3 V\nfrequency: 1 Hz\noffset: 8 V\nduration: 1 s\n"),
            "motion.yaml:4:9: offset must lie between -7 V and 7 V, not 8 V");
  EXPECT_EQ(errors("type: prbs\namplitude: -12 V\nbit: 1 s\nduration: 1 s\n"),
            "motion.yaml:2:12: amplitude must lie between -10 V and 10 V, not -12 V");
  rig_.model.controller.gains.limit = 24.0;
  EXPECT_EQ(errors("type: step\nlevel: 24 V\nduration: 1 s\n"), "");
}

constexpr const char* kMove =
    "type: move\ndistance: 1 m\nspeed: 1 m/s\nacceleration: 2 m/s^2\nduration: 1 s\n";

TEST_F(MotionFileTest, AMoveNeedsAController) {
  EXPECT_EQ(errors(kMove), "");
  rig_ = shipped_axis("emps");
  EXPECT_EQ(errors(kMove),
            "motion.yaml:1:7: a move needs a controller: its standard gains are those of a "
            "set-velocity input, which the drive of this axis does not have; give 'controller' in "
            "the axis file");
  EXPECT_EQ(errors("type: step\nlevel: 1 V\nduration: 1 s\n"), "");
  rig_ = shipped_axis("hobby-servo");
  EXPECT_EQ(errors("type: move\ndistance: 30 deg\nspeed: 1 rad/s\nacceleration: 5 rad/s^2\n"
                   "duration: 1 s\n"),
            "");
}

TEST_F(MotionFileTest, WritesWhatReadsBackTheSame) {
  const std::vector<Motion> motions{
      StepMotion{1.0 / 3.0, 0.1},     LevelsMotion{{8.0, -1.0 / 7.0, 0.0}, 0.15},
      SineMotion{0.3, 2.0, 2.0, 0.1}, SineMotion{-5.0, 0.5, 60.0, 0.0},
      PrbsMotion{4.0, 0.01, 0.5, 7},  MoveMotion{-0.9, 0.8, 1.0 / 3.0}};
  for (const Motion& motion : motions) {
    const std::string text =
        format_motion_file({motion, 2.5}, "made by hand\nfor a test", kSourceVocabulary);
    SCOPED_TRACE(text);
    EXPECT_TRUE(text.starts_with("# made by hand\n# for a test\ntype: "));
    const MotionFile file = read(text);
    EXPECT_EQ(file.duration, 2.5);
    EXPECT_EQ(file.motion.index(), motion.index());
    EXPECT_EQ(format_motion_file(file, "made by hand\nfor a test", kSourceVocabulary), text);
    const Schedule a = schedule_of(motion, 2.5, 5e-3), b = schedule_of(file.motion, 2.5, 5e-3);
    EXPECT_EQ(a.times, b.times);
    EXPECT_EQ(a.values, b.values);
  }
  EXPECT_THROW(format_motion_file({RecordedMotion{}, 1.0}, "", kSourceVocabulary),
               std::logic_error);
}

TEST_F(MotionFileTest, AMoveNeedsACommandThatActsWithinAFewPeriods) {
  rig_.model.axis.T_d = 8.9 * rig_.model.controller.timing.period;
  EXPECT_EQ(errors(kMove), "");
  rig_.model.axis.T_d = 9.0 * rig_.model.controller.timing.period;
  EXPECT_EQ(errors(kMove),
            "motion.yaml:1:7: a move needs a command delay T_d below 9 periods of the "
            "controller's commands");
}

TEST_F(MotionFileTest, EveryMistakeIsNamedWithItsPlace) {
  EXPECT_EQ(errors(""), "motion.yaml:1:1: the file must be a map of keys and values, not empty");
  EXPECT_EQ(errors("type: stp\nlevel: 1 V\nduration: 1 s\n"),
            "motion.yaml:1:7: type must be one of step, levels, sine, chirp, prbs, move, recorded, "
            "not 'stp'; did you mean 'step'?");
  EXPECT_EQ(errors("tipe: step\nlevel: 1 V\nduration: 1 s\n"),
            "motion.yaml:1:1: unknown key 'tipe'; did you mean 'type'?");
  EXPECT_EQ(
      errors("type: chirp\nfrequency: 1 Hz\namplitude: 1\n"),
      "motion.yaml:1:1: key 'duration' is missing in the file\n"
      "motion.yaml:1:1: key 'from' is missing in the file\n"
      "motion.yaml:1:1: key 'to' is missing in the file\n"
      "motion.yaml:2:1: unknown key 'frequency'; known keys: type, duration, amplitude, from, "
      "to, offset\n"
      "motion.yaml:3:12: amplitude needs a unit, for example '1 V'");
  EXPECT_EQ(errors("type: sine\namplitude: 1 V\nfrequency: 6 rad/s\nduration: 0 s\n"),
            "motion.yaml:3:12: frequency: 'rad/s' cannot be converted to 'Hz'; use for example "
            "'Hz'\nmotion.yaml:4:11: duration must lie between 0.001 s and 1e+06 s, not 0 s");
  EXPECT_EQ(errors("type: levels\nlevels: 3 V\nhold: 1 s\nduration: 1 s\n"),
            "motion.yaml:2:9: levels must be a list, not '3 V'");
  EXPECT_EQ(errors("type: prbs\namplitude: 1 V\nbit: 1 s\nseed: -1\nduration: 1 s\n"),
            "motion.yaml:4:7: seed must be a whole number between 0 and 9223372036854775807, not "
            "'-1'");
  EXPECT_EQ(errors(replaced(kMove, "1 m/s\n", "0 m/s\n")),
            "motion.yaml:3:8: speed must lie between 1e-06 m/s and 1000 m/s, not 0 m/s");
}

}  // namespace
}  // namespace axisfit
