#include "init/columns/column_set.h"

#include <gtest/gtest.h>

namespace axisfit {
namespace {

TEST(ColumnSet, HasOneOfEachKindMeasuredAndWanted) {
  ColumnSet columns;
  columns[{Kind::position, false}].shown = "q";
  columns[{Kind::position, true}].shown = "q_des";
  EXPECT_EQ(columns.find(Kind::position)->shown, "q");
  EXPECT_EQ(columns.find(Kind::position, true)->shown, "q_des");
  columns.erase({Kind::position, false});
  EXPECT_EQ(columns.find(Kind::position), nullptr);
  EXPECT_EQ(columns.find(Kind::velocity), nullptr);
}

TEST(ColumnSet, AUnitBringsItsJoint) {
  UnscaledColumn column;
  column.column.kind = Kind::position;
  column.set_unit(*stored_unit(Kind::position, "deg"));
  EXPECT_EQ(column.joint, Joint::revolute);
  EXPECT_EQ(column.column.unit, "deg");
  column.set_size(0.25, Joint::revolute);
  EXPECT_EQ(column.column.unit, "rad");
  EXPECT_TRUE(column.column.stored.empty());
  EXPECT_EQ(column.column.factor, 0.25);
}

TEST(ColumnSet, ANumberIsCalledAColumn) {
  GuessedColumn column;
  column.column = "7";
  EXPECT_EQ(column.title(), "column 7");
  column.column = "7th axis";
  EXPECT_EQ(column.title(), "7th axis");
}

TEST(ColumnSet, ValuesHaveASize) {
  EXPECT_EQ(largest({1.0, -3.0, 2.0}), 3.0);
  EXPECT_TRUE(never_changes({2.0, 2.0}));
  EXPECT_FALSE(never_changes({2.0, 2.0, 1.0}));
}

}  // namespace
}  // namespace axisfit
