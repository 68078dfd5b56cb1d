#include "io/recording/table_builder.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "tests/io/recording/table_fixture.h"

namespace axisfit {
namespace {

using TableBuilderTest = TableTest;

TEST_F(TableBuilderTest, TellsWhatAColumnHoldsBesidesNumbers) {
  const auto obstacle = [&](std::string_view text, std::size_t column) {
    return read(text).columns.at(column).obstacle;
  };
  EXPECT_EQ(obstacle("t,v\n0,abc\n1,2\n", 1),
            "has 'abc' in line 2, which is no number; correct it or leave the field blank");
  EXPECT_EQ(
      obstacle("t;v\n0,5;1\n1;1.5\n", 1),
      "has '1.5' in line 3, with a decimal point, but other numbers have a decimal comma; use "
      "one of them throughout");
  EXPECT_EQ(obstacle("t,v\n0,1\n1,1e999\n", 1),
            "has '1e999' in line 3, which is out of the range of a double; choose another unit or "
            "fix the number");
  EXPECT_EQ(obstacle("t,v\n0,1\n1,inf\n", 1),
            "has 'inf' in line 3, which is not finite; remove the row or cut the recording there");
  EXPECT_EQ(obstacle("t,v\n0,\n1,nan\n", 1), "has no values");
  EXPECT_EQ(obstacle("t,v\n0,abc\n1,2\n", 0), "");
}

TEST_F(TableBuilderTest, KeepsTheTextOfTheFileInMessagesShort) {
  const Table table = read("a\n1\n2\n3\nx\x1B[31m" + std::string(500, 'y') + "1\n");
  EXPECT_LT(table.columns[0].obstacle.size(), 200u);
}

TEST_F(TableBuilderTest, TellsWhichColumnARowLacksOrExceeds) {
  EXPECT_EQ(error("t,q,u\n0,1,2\n1,2\n"),
            "rec.csv:3: 2 fields for the 3 columns of the header, none for column 'u'; complete or "
            "remove the row");
  EXPECT_EQ(error("t,q,u\n0,1\n1,2\n"),
            "rec.csv:2: 2 fields for the 3 columns of the header, none for column 'u'; complete or "
            "remove the row");
  EXPECT_EQ(error("t,x\n0,1\n1,2,3\n"),
            "rec.csv:3: 3 fields for the 2 columns of the header, more after column 'x'; name them "
            "or remove them; or, if these are decimal commas, separate the fields by semicolons");
  EXPECT_EQ(error("t\n0\n1,2\n"),
            "rec.csv:3: 2 fields for the 1 column of the header, more after column 't'; name them "
            "or remove them; or, if these are decimal commas, separate the fields by semicolons");
  EXPECT_EQ(read("t,q,\n0,1,,,\n1,2\n").columns.size(), 2u);
  EXPECT_EQ(read("t,q\n,\n0,1\n,\n1,2\n").rows(), 2u);
}

TEST_F(TableBuilderTest, ARowReadsAlikeWhereverItStands) {
  // The first thousand rows are split into fields; below them plain rows are read in one go.
  std::string above = "a,b\n";
  for (int i = 0; i < 1100; ++i) above += "0,0.5\n";
  const auto last_row = [&](const std::string& text) {
    const std::string message = error(text);
    if (message != "no error") return message.substr(message.find(' '));
    const Table table = read(text);
    std::string values;
    for (const Column& column : table.columns)
      values += std::to_string(column.values.back()) + (column.obstacle.empty() ? " " : "! ");
    return values;
  };
  for (const char* const row :
       {"1,-2.5e3", "+1,-2500", " 1 ,\t-2500 ", "\"1\",-2500", "1,-2500\r", "1", "1,2,3", "1,2,",
        "1,", ",2", "1,inf", "1,nan", "1,2x", "1e999,2", "0x1,2", "1;2", "\"1,2", "1,2 3"})
    EXPECT_EQ(last_row(std::string("a,b\n0,0.5\n0,0.5\n0,0.5\n") + row + "\n"),
              last_row(above + row + "\n"))
        << row;
}

TEST_F(TableBuilderTest, LinesBetweenRowsDoNotCountUnlessTheyAreText) {
  EXPECT_EQ(read("t\r\n0\r\n\r\n# pause\r\n1\r\n").columns[0].values, (Values{0, 1}));
  EXPECT_EQ(read("t,x\n0,1\n1,2\nEOF\n").rows(), 2u);
  EXPECT_EQ(error("t,x\n0,1\n1,2\nt,x\n0,1\n1,2\n2,3\n3,4\n4,5\n5,6\n6,7\n7,8\n8,9\n9,9\n"),
            "rec.csv:4: 't' is no row of numbers, but rows follow; remove the line, or the rows of "
            "another recording");
}

}  // namespace
}  // namespace axisfit
