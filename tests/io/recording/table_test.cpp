#include "io/recording/table.h"

#include <gtest/gtest.h>

#include "tests/io/recording/table_fixture.h"

namespace axisfit {
namespace {

TEST_F(TableTest, FindsColumnsByExactName) {
  const Table table = read("q,Q\n1,2\n");
  EXPECT_EQ(table.find("Q"), &table.columns[1]);
  EXPECT_EQ(table.find("x"), nullptr);
  EXPECT_EQ(table.find(""), nullptr);
}

TEST(Table, WithoutColumnsHasNoRows) { EXPECT_EQ(Table{}.rows(), 0u); }

TEST(Table, NamesRowsWhenThereAreNoLines) {
  EXPECT_EQ((Table{"rec.mat", {{"t", {0, 1}}}, {}}).where(1), "rec.mat: row 2");
}

TEST(RecordingError, NamesTheLineOnlyWhenThereIsOne) {
  EXPECT_STREQ(RecordingError("rec.csv", 17, "no").what(), "rec.csv:17: no");
  EXPECT_STREQ(RecordingError("rec.csv", 0, "no").what(), "rec.csv: no");
}

TEST(Table, SeriesOfEqualTimesShareAClock) {
  Table table{"a", {}};
  add_series(table, {"t a", {0, 1}}, {"a", {1, 2}});
  add_series(table, {"t b", {0, 1}}, {"b", {3, 4}});
  add_series(table, {"t c", {0, 2}}, {"c", {5, 6}});
  ASSERT_EQ(table.columns.size(), 5u);
  EXPECT_EQ(table.columns[1].clock, 0u);
  EXPECT_EQ(table.columns[2].clock, 0u);
  EXPECT_EQ(table.columns[3].name, "t c");
  EXPECT_EQ(table.columns[4].clock, 3u);
}

}  // namespace
}  // namespace axisfit
