#include "io/recording/text_layout.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/io/recording/table_fixture.h"

namespace axisfit {
namespace {

using TextLayoutTest = TableTest;

TEST_F(TextLayoutTest, SkipsCommentsAboveTheNames) {
  for (const char* text : {"# rig 7\n#\nt,x\n1,2\n3,4\n", "% rig, 7\n% t,x\n1,2\n3,4\n",
                           "// rig 7\n// 2 kHz\nt,x\ns,m\n1,2\n3,4\n", "# t,x\n1,2\n3,4\n",
                           "#t,x\r\n-1,2\r\n3,4\r\n"}) {
    SCOPED_TRACE(text);
    const Table table = read(text);
    ASSERT_EQ(table.columns.size(), 2u);
    EXPECT_EQ(table.columns[0].name, "t");
    EXPECT_EQ(table.columns[1].name, "x");
    EXPECT_EQ(table.columns[1].values, (std::vector{2.0, 4.0}));
  }
  EXPECT_EQ(read("# rig\nt,x\n1,2\n3,4\n").lines, (std::vector<std::size_t>{3, 4}));
}

TEST_F(TextLayoutTest, ReadsARowOfUnits) {
  for (const char* text :
       {"t;v;k\ns;mm/s;\n0,5;1;2\n1;2,5;3\n", "t,v,k\ns,mm/s,\n0.5,1,2\n1,2.5,3\n",
        "t\tv\tk\n[s]\t[mm/s]\t-\n0.5\t1\t2\n1\t2.5\t3\n",
        "Rig 7, Axis 2\nmade by hand\n\nt,v,k\ns,mm/s,\n0.5,1,2\n1,2.5,3\n"}) {
    SCOPED_TRACE(text);
    const Table table = read(text);
    ASSERT_EQ(table.columns.size(), 3u);
    EXPECT_EQ(table.columns[0].name, "t");
    EXPECT_EQ(table.columns[0].unit, "s");
    EXPECT_EQ(table.columns[1].unit, "mm/s");
    EXPECT_EQ(table.columns[2].unit, "");
    EXPECT_EQ(table.columns[1].values, (Values{1, 2.5}));
  }
}

TEST_F(TextLayoutTest, ColumnsMayLackNames) {
  for (const char* text : {"0,1.5\n0.001,-2e-3\n", "0\t1.5\n0.001\t-2e-3\n", "0 1.5\n0.001 -2e-3\n",
                           "a recording\n\n0,1.5\n0.001,-2e-3\n"}) {
    SCOPED_TRACE(text);
    const Table table = read(text);
    ASSERT_EQ(table.columns.size(), 2u);
    EXPECT_EQ(table.columns[0].name, "");
    EXPECT_EQ(table.columns[1].values, (Values{1.5, -2e-3}));
  }
  EXPECT_EQ(read("t,,q\n0,1,2\n").columns[1].name, "");
  EXPECT_EQ(read("t,q,t\n0,1,2\n").columns[2].name, "t");
}

TEST_F(TextLayoutTest, BlanksMaySeparate) {
  const Table table = read("t  x   y\n 0  1.5 2\n 1 2.5   3\n");
  ASSERT_EQ(table.columns.size(), 3u);
  EXPECT_EQ(table.columns[1].name, "x");
  EXPECT_EQ(table.columns[1].values, (Values{1.5, 2.5}));
  EXPECT_EQ(read("0,5 1,5\n1 2,5\n2 3,5\n").columns[1].values, (Values{1.5, 2.5, 3.5}));
}

}  // namespace
}  // namespace axisfit
