#include "io/recording/wpilog_file.h"

#include <bit>
#include <cstdint>

#include "tests/io/recording/kind_fixture.h"

namespace axisfit {
namespace {

std::string bytes_of(std::uint64_t value, int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i));
  return bytes;
}
std::string real(double value) { return bytes_of(std::bit_cast<std::uint64_t>(value), 8); }
std::string text_of(const std::string& text) { return bytes_of(text.size(), 4) + text; }

const std::string kHeader = std::string("WPILOG\0\1", 8) + text_of("made by a test");

/// With an id of one byte, a size of two and a time of three, in us.
std::string record(int id, std::uint64_t time, const std::string& data) {
  return "\x24" + bytes_of(static_cast<std::uint64_t>(id), 1) + bytes_of(data.size(), 2) +
         bytes_of(time, 3) + data;
}
std::string start(int id, const std::string& name, const std::string& type) {
  return record(0, 0,
                std::string(1, '\0') + bytes_of(static_cast<std::uint64_t>(id), 4) + text_of(name) +
                    text_of(type) + text_of("{\"source\":\"NT\"}"));
}
std::string finish(int id) {
  return record(0, 9, "\1" + bytes_of(static_cast<std::uint64_t>(id), 4));
}

using WpilogTest = KindTest;

TEST_F(WpilogTest, ReadsEveryNumberWithItsTimes) {
  const RecordingFile file =
      read(kHeader + start(1, "/arm/position", "double") + start(2, "/arm/volts", "float") +
           start(3, "/arm/count", "int64") + start(4, "/arm/on", "boolean") +
           record(1, 1'000'000, real(0.25)) + record(3, 1'000'000, bytes_of(~std::uint64_t{4}, 8)) +
           record(2, 1'020'000, bytes_of(std::bit_cast<std::uint32_t>(-1.5F), 4)) +
           record(4, 1'040'000, "\1") + record(1, 1'040'000, real(0.5)));
  EXPECT_EQ(column(file, "/arm/position").values, (Values{0.25, 0.5}));
  EXPECT_EQ(clock(file, "/arm/position").name, "Time (/arm/position)");
  EXPECT_EQ(clock(file, "/arm/position").unit, "s");
  EXPECT_EQ(clock(file, "/arm/position").values, (Values{0.0, 0.04}));
  EXPECT_EQ(column(file, "/arm/volts").values, Values{-1.5});
  EXPECT_EQ(clock(file, "/arm/volts").values, Values{0.02});
  EXPECT_EQ(column(file, "/arm/count").values, Values{-5});
  EXPECT_EQ(column(file, "/arm/on").values, Values{1});
}

TEST_F(WpilogTest, TheTimesOfTheWholeFileBeginAtZero) {
  // The spec's example, and records that are not in order.
  const RecordingFile file = read(kHeader + start(1, "b", "int64") + start(2, "a", "double") +
                                  std::string("\x20\x01\x08\x40\x42\x0f\x03\0\0\0\0\0\0\0", 14) +
                                  record(2, 500'000, real(1)));
  EXPECT_EQ(column(file, "b").values, Values{3});
  EXPECT_EQ(clock(file, "b").values, Values{0.5});
  EXPECT_EQ(clock(file, "a").values, Values{0.0});
}

TEST_F(WpilogTest, AnArrayHasAColumnForEachElement) {
  const RecordingFile file = read(kHeader + start(1, "q", "double[]") + record(1, 0, "") +
                                  record(1, 1000, real(1) + real(2)) +
                                  record(1, 2000, real(3) + real(4)) + record(1, 3000, real(5)));
  EXPECT_EQ(column(file, "q[0]").values, (Values{1, 3}));
  EXPECT_EQ(column(file, "q[1]").values, (Values{2, 4}));
  EXPECT_EQ(clock(file, "q[1]").values, (Values{0, 0.001}));
  EXPECT_EQ(file.columns().size(), 3u);
}

TEST_F(WpilogTest, WhatStartsAgainGoesOn) {
  const RecordingFile file =
      read(kHeader + start(1, "a", "double") + record(1, 0, real(1)) + finish(1) +
           record(1, 5, real(9)) + start(1, "b", "double") + record(1, 10, real(2)) +
           start(2, "a", "double") + record(2, 20, real(3)) + start(3, "a", "int64") +
           record(3, 30, bytes_of(4, 8)));
  EXPECT_EQ(column(file, "a").values, (Values{1, 3}));
  EXPECT_EQ(column(file, "b").values, Values{2});
  EXPECT_EQ(column(file, "a(2)").values, Values{4});
}

TEST_F(WpilogTest, SaysOfOtherTypesWhatTheyAre) {
  const RecordingFile file =
      read(kHeader + start(1, "x", "double") + start(2, "pose", "struct:Pose2d") +
           start(3, "never", "double") + start(4, "large", "boolean[]") + record(1, 0, real(1)) +
           record(2, 0, std::string(24, '\7')) + record(4, 0, std::string(600, '\1')));
  EXPECT_EQ(problem(file, "pose"),
            "'pose' in run.dat has values of the type 'struct:Pose2d', which are no numbers; log "
            "its numbers by themselves");
  EXPECT_EQ(problem(file, "never"), "'never' in run.dat has no values");
  EXPECT_EQ(problem(file, "large"),
            "'large' in run.dat has more than 64 numbers in a record; log those of the axis by "
            "themselves");
  EXPECT_EQ(error(kHeader + start(1, "console", "string") + record(1, 0, "hello")),
            "run.dat: has no numbers: 'console' has values of the type 'string', which are no "
            "numbers; log its numbers by themselves");
  EXPECT_EQ(error(kHeader), "run.dat: has no records; log the signals of the axis");
}

TEST_F(WpilogTest, ReadsAFileWhoseEndIsMissing) {
  const std::string whole =
      kHeader + start(1, "x", "double") + record(1, 0, real(1)) + record(1, 10, real(2));
  for (std::size_t cut = 1; cut < 15; ++cut)
    EXPECT_EQ(column(read(whole.substr(0, whole.size() - cut)), "x").values, Values{1}) << cut;
  // One that was made longer than it was filled.
  EXPECT_EQ(column(read(whole + std::string(64, '\0')), "x").values, (Values{1, 2}));
}

TEST_F(WpilogTest, RefusesWhatIsDamaged) {
  const std::string begun = kHeader + start(1, "x", "double");
  const auto why = [&](const std::string& contents) {
    const std::string message = error(contents);
    return message.substr(message.find(": ", message.find("byte")) + 2);
  };
  EXPECT_EQ(error(begun + record(7, 0, real(1))),
            "run.dat: is damaged before byte " + std::to_string(begun.size() + 7) +
                ": a record is of no entry; copy it again from the robot");
  EXPECT_EQ(why(begun + record(1, 0, "abc")),
            "a record of 'x' is not as long as its type; copy it again from the robot");
  EXPECT_EQ(why(begun + "\xA0"),
            "a record begins with a bit that is always zero; copy it again from the robot");
  EXPECT_EQ(why(kHeader + record(0, 0, std::string("\0\1\0\0\0\xFF\0\0\0x", 10))),
            "a control record ends early; copy it again from the robot");
  EXPECT_EQ(why(kHeader + record(0, 0, "\5" + bytes_of(1, 4))),
            "a control record is of an unknown type; copy it again from the robot");
  EXPECT_EQ(error(std::string("WPILOG\0\2\0\0\0\0", 12)),
            "run.dat: is a data log of version 2, and only 1 is known; export it as CSV with "
            "AdvantageScope or the Data Log Tool");
  EXPECT_EQ(error("WPILOG"), "run.dat: is no data log of WPILib; copy it again from the robot");
}

}  // namespace
}  // namespace axisfit
