// What the columns of a recording are, by their names and values.
#include "init/recording_guess.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/apps/files.h"

namespace axisfit {
namespace {

/// A slow swing of 0.1 m: its times in units of `per_second`, its position in units of `per_metre`.
Table swing(double per_second, double per_metre) {
  Table table;
  table.columns = {{"time [ms]", {}}, {"iq [A]", {}}, {"x", {}}, {"velocity [m/s]", {}}};
  for (int i = 0; i < 400; ++i) {
    const double t = 0.005 * i;
    table.columns[0].values.push_back(per_second * t);
    table.columns[1].values.push_back(std::cos(3.0 * t));
    table.columns[2].values.push_back(per_metre * 0.1 * std::sin(3.0 * t));
    table.columns[3].values.push_back(0.3 * std::cos(3.0 * t));
  }
  return table;
}

RecordingGuess guess_of(const Table& table) {
  const TempFolder folder;
  const std::string path = folder.write("a.csv", table);
  RecordingGuess guess = guess_recording(RecordingFile(path), path);
  write_units(guess, Joint::prismatic);
  return guess;
}

TEST(RecordingGuessTest, APositionHasTheUnitThatItsVelocityTells) {
  for (const auto& [per_metre, unit] : {std::pair{1.0, "m"}, {1e2, "cm"}, {1e3, "mm"}}) {
    const RecordingGuess guess = guess_of(swing(1e3, per_metre));
    const GuessedColumn* position = guess.find(Kind::position);
    ASSERT_NE(position, nullptr);
    EXPECT_EQ(position->unit, unit);
    EXPECT_EQ(position->factor, 1.0);
    EXPECT_FALSE(position->guessed) << "it was measured";
    EXPECT_NEAR(position->values[100], 0.1 * std::sin(1.5), 1e-12);
    EXPECT_NEAR(guess.time.values[100], 0.5, 1e-12);
  }
}

TEST(RecordingGuessTest, WhereNothingTellsTheUnitTheJointDoes) {
  for (const auto& [largest, length, angle] : {std::tuple{1.0, "m", "rad"}, {1e3, "mm", "deg"}}) {
    Table table = swing(1e3, 10.0 * largest);
    table.columns.pop_back();
    const TempFolder folder;
    const std::string path = folder.write("a.csv", table);
    for (const Joint joint : {Joint::prismatic, Joint::revolute}) {
      RecordingGuess guess = guess_recording(RecordingFile(path), path, {}, joint);
      EXPECT_EQ(is_of_angles(guess), joint == Joint::revolute);
      EXPECT_TRUE(has_motion_without_unit(guess));
      write_units(guess, joint);
      const GuessedColumn& position = *guess.find(Kind::position);
      EXPECT_EQ(position.unit, joint == Joint::revolute ? angle : length);
      EXPECT_EQ(position.factor, 1.0);
    }
  }
  EXPECT_FALSE(has_motion_without_unit(guess_of(swing(1e3, 1.0))));
}

TEST(RecordingGuessTest, ATimeHasTheUnitThatPositionAndVelocityTell) {
  Table table = swing(1e6, 1e3);
  table.columns[0].name = "time";
  table.columns[2].name = "x [mm]";
  const RecordingGuess guess = guess_of(table);
  EXPECT_EQ(guess.time.unit, "us");
  EXPECT_FALSE(guess.time.guessed);
  EXPECT_NEAR(guess.time.values[100], 0.5, 1e-12);
}

TEST(RecordingGuessTest, AnAnswerComesBeforeNamesAndValues) {
  const TempFolder folder;
  Table table = swing(1.0, 1.0);
  table.columns[1].name = "Status";
  const std::string path = folder.write("a.csv", table);
  const auto position = [&](const std::string& answer) {
    const RecordingGuess guess = guess_recording(RecordingFile(path), path, {read_answer(answer)});
    return *guess.find(Kind::position);
  };
  for (const char* answer : {"position=Status:um/8", "position=2:um/8"}) {
    const GuessedColumn found = position(answer);
    EXPECT_EQ(found.column, "Status");
    EXPECT_EQ(found.unit, "um");
    EXPECT_EQ(found.factor, 0.125);
    EXPECT_FALSE(found.guessed);
  }
  EXPECT_DOUBLE_EQ(position("position=2:deg*0.5").factor, 0.5 * std::numbers::pi / 180.0);
}

TEST(ReadAnswer, SaysWhatIsWrong) {
  const auto refusal = [](const char* text) {
    try {
      read_answer(text);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  const std::string how =
      "; write SIGNAL=COLUMN:UNIT, such as position=3:mm, position=\"Geber [Ink]:um/8\" or "
      "force=Torque:N*0.2";
  EXPECT_EQ(refusal("position=x"),
            "--column position=x: the signal, the column or the unit is missing" + how);
  EXPECT_EQ(refusal("positon=x:mm").find("--column positon=x:mm: there is no signal 'positon'"),
            0u);
  EXPECT_EQ(refusal("force=x:N*0"),
            "--column force=x:N*0: the factor must be a number other than zero" + how);
  EXPECT_NE(refusal("force=x:mm").find("--column force=x:mm: "), std::string::npos);
  EXPECT_EQ(refusal("velocity=a: b:mm/s"), "none");
}

TEST(RecordingGuessTest, ValuesTellWhatHasNoName) {
  const RecordingFile file(AXISFIT_TESTDATA "/drives/headerless.txt");
  const RecordingGuess guess = guess_recording(file, "headerless.txt");
  EXPECT_EQ(guess.time.column, "1");
  EXPECT_EQ(guess.find(Kind::command)->column, "2");
  EXPECT_EQ(guess.find(Kind::position)->column, "3");
  EXPECT_EQ(guess.find(Kind::position)->unit, "mm");
  EXPECT_EQ(guess.find(Kind::velocity)->column, "4");
  EXPECT_EQ(guess.find(Kind::velocity)->unit, "mm/s");
  EXPECT_TRUE(guess.find(Kind::position)->guessed);
}

TEST(GuessRecording, AClockIsATimeWhateverItIsTheTimeOf) {
  Table table = swing(1.0, 1.0);
  std::string text = "Timestamp,Key,Value\n";
  for (std::size_t i = 0; i < table.rows(); ++i)
    for (std::size_t c : {1U, 3U})
      text += std::to_string(table.columns[0].values[i] + 0.001 * double(c)) + "," +
              (c == 1 ? "/current" : "/velocity") + "," +
              std::to_string(table.columns[c].values[i]) + "\n";
  const TempFolder folder;
  const std::string path = folder.write("list.csv", text);
  const RecordingGuess guess = guess_recording(RecordingFile(path), path);
  EXPECT_EQ(guess.time.column, "Time (/current)");
  ASSERT_EQ(guess.columns.size(), 2u);
  for (const GuessedColumn& column : guess.columns)
    EXPECT_TRUE(column.column == "/current" || column.column == "/velocity") << column.column;
}

}  // namespace
}  // namespace axisfit
