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
      RecordingGuess guess = guess_recording(RecordingFile(path), path, {{}, joint, {}});
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

TEST(RecordingGuessTest, ATorqueTurnsAJointUnlessItMovesInLengths) {
  Table table = swing(1.0, 1.0);
  table.columns[1].name = "tau";
  table.columns[3].name = "velocity";
  RecordingGuess guess = guess_of(table);
  EXPECT_TRUE(is_of_angles(guess));
  EXPECT_EQ(guess.find(Kind::force)->stored, "N m");
  table.columns[2].name += "_mm";
  guess = guess_of(table);
  EXPECT_FALSE(is_of_angles(guess));
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
    RecordingGuess guess =
        guess_recording(RecordingFile(path), path, {{.columns = {read_answer(answer)}}});
    write_units(guess, Joint::prismatic);
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

TEST(RecordingGuessTest, AnAnswerKeepsTheTurnsThatWereFound) {
  Table table = swing(1e3, 1.0);
  table.columns.pop_back();
  table.columns[2].name = "Geber";
  std::vector<double>& counts = table.columns[2].values;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double count = std::floor(4096.0 * (1.6 + 1.5 * std::sin(0.015 * double(i))));
    counts[i] = count - 4096.0 * std::floor(count / 4096.0);
  }
  const TempFolder folder;
  const std::string path = folder.write("a.csv", table);
  for (const char* answer : {"position=Geber:rev/4096", "position=Geber"}) {
    RecordingGuess guess =
        guess_recording(RecordingFile(path), path, {{.columns = {read_answer(answer)}}});
    EXPECT_TRUE(is_of_angles(guess));
    write_units(guess, Joint::revolute);
    const GuessedColumn& position = *guess.find(Kind::position);
    EXPECT_EQ(position.overflow.wraps_after, 4096.0) << answer;
    EXPECT_EQ(position.unit, "rev");
    EXPECT_DOUBLE_EQ(position.factor, 1.0 / 4096.0);
    EXPECT_NEAR(position.values[100],
                2.0 * std::numbers::pi * (1.6 + 1.5 * std::sin(1.5)) -
                    2.0 * std::numbers::pi * std::floor(1.6),
                2e-3);
    EXPECT_EQ(position.guessed, answer == std::string("position=Geber"));
  }
}

TEST(RecordingGuessTest, ANegativeFactorTurnsTheColumn) {
  const TempFolder folder;
  const std::string path = folder.write("a.csv", swing(1e3, 1e3));
  RecordingGuess guess =
      guess_recording(RecordingFile(path), path, {{.columns = {read_answer("position=x:mm*-1")}}});
  write_units(guess, Joint::prismatic);
  EXPECT_EQ(guess.find(Kind::position)->factor, -1.0);
  EXPECT_NEAR(guess.find(Kind::position)->values[100], -0.1 * std::sin(1.5), 1e-12);
  EXPECT_TRUE(guess.find(Kind::velocity)->negative) << "which must go with it";
}

TEST(RecordingGuessTest, ADutyIsAPartOfItsSupply) {
  Table table = swing(1e3, 1e3);
  table.columns[1].name = "pwm";
  for (double& x : table.columns[1].values) x = std::round(250.0 * x);
  std::vector<double> volts;
  for (std::size_t i = 0; i < 400; ++i) volts.push_back(12.0 - 0.5 * std::sin(0.1 * double(i)));
  for (const char* name : {"Vbat", "battery [V]", "voltage [V]"}) {
    Table with = table;
    with.columns.push_back({name, volts});
    RecordingGuess guess = guess_of(with);
    const GuessedColumn& duty = *guess.find(Kind::command);
    EXPECT_EQ(duty.supply, name);
    EXPECT_EQ(duty.supply_unit, "V");
    EXPECT_DOUBLE_EQ(duty.factor, 1.0 / 255.0);
    EXPECT_NEAR(duty.values[100], std::round(250.0 * std::cos(1.5)) / 255.0 * volts[100], 1e-9);
    EXPECT_TRUE(guess.channels.empty());
  }
  const RecordingGuess without = guess_of(table);
  EXPECT_EQ(without.find(Kind::command)->unit, "V");
  EXPECT_TRUE(without.find(Kind::command)->guessed);
}

TEST(RecordingGuessTest, ASupplyIsWhatTheUserSays) {
  Table table = swing(1e3, 1e3);
  table.columns[1].name = "out";
  table.columns.push_back({"ch7", std::vector<double>(400, 24000.0)});
  const TempFolder folder;
  const std::string path = folder.write("a.csv", table);
  const Answers answers{.columns = {read_answer("duty=out:%"), read_answer("supply=ch7:mV")}};
  const RecordingGuess guess = guess_recording(RecordingFile(path), path, {answers});
  EXPECT_EQ(guess.find(Kind::command)->supply, "ch7");
  EXPECT_EQ(guess.find(Kind::command)->supply_unit, "mV");
  EXPECT_NEAR(guess.find(Kind::command)->values[100], 0.01 * 24.0 * std::cos(1.5), 1e-12);
}

TEST(RecordingGuessTest, WithoutTimesTheRateTells) {
  Table table = swing(1.0, 1e3);
  table.columns.erase(table.columns.begin());
  const TempFolder folder;
  const std::string path = folder.write("a.csv", table);
  EXPECT_THROW(guess_recording(RecordingFile(path), path), RecordingError);
  const RecordingGuess guess = guess_recording(RecordingFile(path), path, {{.rate = 200.0}});
  EXPECT_EQ(guess.rate, 200.0);
  EXPECT_EQ(guess.find(Kind::position)->unit, "mm");
  EXPECT_FALSE(guess.find(Kind::position)->guessed);
}

RecordingGuess of_contact(const std::string& file, Answers answers = {}) {
  const std::string path = AXISFIT_TESTDATA "/contact/" + file;
  return guess_recording(RecordingFile(path), path, {std::move(answers)});
}

TEST(RecordingGuessTest, AReferenceIsNotTheMeasurement) {
  const RecordingGuess guess = of_contact("q-and-q-des.csv");
  EXPECT_EQ(guess.find(Kind::position)->column, "q");
  EXPECT_EQ(guess.find(Kind::position, true)->column, "q_des");
  EXPECT_EQ(guess.find(Kind::velocity)->column, "dq");
  EXPECT_EQ(guess.find(Kind::force)->column, "tau_meas");
}

TEST(RecordingGuessTest, APositionGoesWithItsOwnCurrent) {
  const RecordingGuess guess = of_contact("two-motors.csv");
  EXPECT_EQ(guess.find(Kind::position)->column, "Motor 1 Position");
  EXPECT_EQ(guess.find(Kind::velocity)->column, "Motor 1 Velocity");
  EXPECT_EQ(guess.find(Kind::current)->column, "Motor 1 Current");
  EXPECT_EQ(guess.motor, "1");
  ASSERT_EQ(guess.notes.size(), 1u);
  EXPECT_EQ(of_contact("two-motors.csv", {.motor = "0"}).find(Kind::current)->column,
            "Motor 0 Current");
}

TEST(RecordingGuessTest, RepeatedStampsAreNamedWithTheirLines) {
  try {
    of_contact("repeated-stamps.csv");
    ADD_FAILURE();
  } catch (const RecordingError& error) {
    EXPECT_NE(std::string(error.what()).find("timestamp_ms does not increase in 1 row: "),
              std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find(":25 (3227, after 3227)"), std::string::npos)
        << error.what();
  }
}

TEST(RecordingGuessTest, AClockIsATimeWhateverItIsTheTimeOf) {
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
