#include "io/recording/recording_file.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "tests/apps/files.h"
#include "tests/io/recording/three_rows.h"

namespace axisfit {
namespace {

TEST(RecordingFile, FindsAColumnByItsNameOrElseItsNumber) {
  const RecordingFile file = recording();
  const auto first = [&](const char* name) {
    const auto found = file.column(name);
    return std::get<const Column*>(found)->values.front();
  };
  EXPECT_EQ(first("speed"), 100.0);
  EXPECT_EQ(first("2"), 100.0);
  EXPECT_EQ(first("7"), 4.0);
  EXPECT_EQ(first("5"), 3.0);
}

TEST(RecordingFile, SaysWhatThereIsInsteadOfAColumn) {
  const RecordingFile file = recording();
  EXPECT_EQ(std::get<std::string>(file.column("sped")),
            "no column 'sped' in a.csv; did you mean 'speed'? It has time, speed, twice, twice, 7, "
            "text, huge");
  EXPECT_TRUE(std::holds_alternative<std::string>(file.column("9")));
  EXPECT_EQ(file.where(1), "a.csv:3");
}

TEST(RecordingFile, AColumnIsCalledByItsNameWhereThatIsItsOwn) {
  const RecordingFile file = recording();
  EXPECT_EQ(file.reference(1), "speed");
  EXPECT_EQ(file.reference(2), "3");  // named twice
  EXPECT_EQ(file.reference(4), "5");  // not named
  EXPECT_EQ(file.reference(5), "6");  // named by a number
}

TEST(RecordingFile, IsReadAsWhatItsNameEndsIn) {
  const TempFolder folder;
  const std::string text = "t,x\n0,1\n1,2\n";
  EXPECT_EQ(RecordingFile(folder.write("a.txt", text)).columns().size(), 2u);
  for (const char* name : {"a.mat", "a.mcap", "a.xlsx"})
    EXPECT_THROW(RecordingFile(folder.write(name, text)), RecordingError) << name;
}

TEST(RecordingFile, IsReadAsWhatItBeginsWith) {
  const TempFolder folder;
  const auto columns = [&](const std::string& text) {
    return RecordingFile(folder.write("run.csv", text)).columns().size();
  };
  EXPECT_EQ(columns("{\"t\": [0, 1], \"x\": [2, 3]}"), 2u);
  EXPECT_EQ(columns("[{\"t\": 0, \"x\": 1}]"), 2u);
  EXPECT_EQ(columns("Timestamp,Key,Value\n0,a,1\n1,b,2\n"), 4u);
  EXPECT_EQ(columns("[key]; [value]\n0.Variable; a\n; 0; 1\n"), 2u);
  EXPECT_EQ(columns("# Sampling period is 1000 ns\na\n1\n"), 2u);
  EXPECT_EQ(columns("{\"slow-forward\": [[0, 1, 2, 3]], \"units\": \"Meters\"}"), 4u);
}

TEST(RecordingFile, ANumberSignSaysWhichRecordingOfAFile) {
  const TempFolder folder;
  const std::string file = folder.write("a.csv", "t,x\n0,1\n");
  EXPECT_EQ(file_of_recording(file), file);
  EXPECT_EQ(file_of_recording(file + "#one"), file);
  EXPECT_EQ(file_of_recording(folder.path("none.csv#one")), folder.path("none.csv#one"));
  // What is called so is that file.
  const std::string odd = folder.write("a.csv#1", "t,x\n0,1\n");
  EXPECT_EQ(file_of_recording(odd), odd);
  EXPECT_EQ(RecordingFile(odd).columns().size(), 2u);
}

TEST(RecordingFile, HasNotTooManyColumns) {
  const TempFolder folder;
  std::string text = "Timestamp,Key,Value\n";
  for (int i = 0; i < 16384; ++i) text += "0,k" + std::to_string(i) + ",1\n";
  try {
    RecordingFile(folder.write("a.csv", text));
    FAIL() << "no error";
  } catch (const RecordingError& caught) {
    EXPECT_EQ(folder.without_path(caught.what()),
              "a.csv: has more than 16384 columns; export only the signals of the axis");
  }
}

}  // namespace
}  // namespace axisfit
