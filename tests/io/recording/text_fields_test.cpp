#include "io/recording/text_fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/io/recording/table_fixture.h"

namespace axisfit {
namespace {

using TextFieldsTest = TableTest;

TEST_F(TextFieldsTest, TakesNothingElseForANumber) {
  for (const char* text : {"1 2", "1.2.3", "0x10", "1e", ".", "+", "+-1", "--1", "1,000,000",
                           "1.000,5", "1,5e", ",", "1d3", "12 s", "inf", "-Infinity", "1e-999"}) {
    SCOPED_TRACE(text);
    const Table table = read(std::string("a;b\n0;7\n1;8\n2;") + text + "\n");
    ASSERT_EQ(table.columns.size(), 2u);
    EXPECT_FALSE(table.columns[1].obstacle.empty());
  }
}

TEST_F(TextFieldsTest, MissingValuesAreNaN) {
  for (const char* missing :
       {"", "NaN", "nan", "N/A", "#N/A", "NULL", "none", "-", "NaN(1)", "\"\""}) {
    SCOPED_TRACE(missing);
    const Table table = read(std::string("t,v\n0,1\n1,") + missing + "\n2,3\n");
    EXPECT_EQ(table.columns[1].obstacle, "");
    EXPECT_EQ(table.rows(), 3u);
    EXPECT_TRUE(std::isnan(table.columns[1].values[1]));
    EXPECT_EQ(table.columns[1].values[2], 3.0);
  }
}

TEST_F(TextFieldsTest, TrueAndFalseAreNumbers) {
  EXPECT_EQ(read("t,on\n0,TRUE\n1,false\n").columns[1].values, (Values{1, 0}));
}

TEST_F(TextFieldsTest, ReadsDatesAndTimes) {
  const Values iso = read("Timestamp;v\n2026-03-16T17:04:51.25Z;1\n2026-03-16 18:04:51,5+01:00;2\n")
                         .columns[0]
                         .values;
  EXPECT_EQ(iso, (Values{1773680691.25, 1773680691.5}));
  EXPECT_EQ(read("clock;v\n10:15:30.125;1\n10:15:31;2\n").columns[0].values,
            (Values{36930.125, 36931.0}));
  for (const char* wrong : {"2026-13-16T17:04:51", "2026-03-16", "24:00:00", "10:15", "10:61:00"})
    EXPECT_NE(read(std::string("c;v\n0;0\n1;1\n") + wrong + ";2\n").columns[0].obstacle, "")
        << wrong;
}

TEST_F(TextFieldsTest, QuotedNamesMayHoldDelimitersAndQuotes) {
  const Table table = read("\"q (rad, motor)\";\"the \"\"raw\"\" one\"\n1;2\n");
  ASSERT_EQ(table.columns.size(), 2u);
  EXPECT_EQ(table.columns[0].name, "q (rad, motor)");
  EXPECT_EQ(table.columns[1].name, "the \"raw\" one");
}

}  // namespace
}  // namespace axisfit
