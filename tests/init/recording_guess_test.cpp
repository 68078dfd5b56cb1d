// What the columns of a recording are, by their names and values.
#include "init/recording_guess.h"

#include <gtest/gtest.h>

#include <cmath>
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
  return guess_recording(RecordingFile(path), path);
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

TEST(RecordingGuessTest, ATimeHasTheUnitThatPositionAndVelocityTell) {
  Table table = swing(1e6, 1e3);
  table.columns[0].name = "time";
  table.columns[2].name = "x [mm]";
  const RecordingGuess guess = guess_of(table);
  EXPECT_EQ(guess.time.unit, "us");
  EXPECT_FALSE(guess.time.guessed);
  EXPECT_NEAR(guess.time.values[100], 0.5, 1e-12);
}

}  // namespace
}  // namespace axisfit
