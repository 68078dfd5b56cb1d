#include "io/recording/change_list_file.h"

#include "tests/io/recording/kind_fixture.h"

namespace axisfit {
namespace {

using ChangeListTest = KindTest;

TEST_F(ChangeListTest, EveryKeyHasTheTimesOfItsChanges) {
  const RecordingFile file = read(
      "Timestamp,Key,Value\n0.5,/Arm/Position,0.25\n0.5,/Arm/Volts,12\n0.52,/Arm/Position,0.5\n"
      "0.54,/Arm/Position,0.75\n0.54,/Arm/On,true\n0.54,/Arm/Volts,-1e1\n");
  EXPECT_EQ(column(file, "/Arm/Position").values, (Values{0.25, 0.5, 0.75}));
  EXPECT_EQ(clock(file, "/Arm/Position").name, "Time (/Arm/Position)");
  EXPECT_EQ(clock(file, "/Arm/Position").values, (Values{0.5, 0.52, 0.54}));
  EXPECT_EQ(clock(file, "/Arm/Position").unit, "s");
  EXPECT_EQ(column(file, "/Arm/Volts").values, (Values{12, -10}));
  EXPECT_EQ(clock(file, "/Arm/Volts").values, (Values{0.5, 0.54}));
  EXPECT_EQ(column(file, "/Arm/On").values, Values{1});
}

TEST_F(ChangeListTest, KeysThatChangeTogetherShareAClock) {
  const RecordingFile file = read("Timestamp,Key,Value\n0,a,1\n0,b,2\n1,a,3\n1,b,4\n");
  EXPECT_EQ(file.columns().size(), 3u);
  EXPECT_EQ(column(file, "a").clock, column(file, "b").clock);
}

TEST_F(ChangeListTest, TimesMayBeDates) {
  const RecordingFile file = read(
      "[Timestamp];[NAME];[VALUE]\r\n2026-03-16 17:04:51;MAIN.pos;1,5\r\n"
      "2026-03-16 17:04:52;MAIN.pos;2,5\r\n");
  EXPECT_EQ(column(file, "MAIN.pos").values, (Values{1.5, 2.5}));
  const Values& times = clock(file, "MAIN.pos").values;
  EXPECT_EQ(times[1] - times[0], 1.0);
  // What a number means that is only called a time is not known.
  EXPECT_EQ(clock(read("time,name,value\n0,a,1\n1000,a,2\n"), "a").unit, "");
}

TEST_F(ChangeListTest, SaysWhereAValueIsNoNumber) {
  const RecordingFile file = read(
      "Timestamp,Key,Value\n0,a,1\n0,mode,\"idle\"\n1,mode,\"run, \"\"now\"\n1,a,null\n2,a,3\n"
      "2,q,[1; 2]\n");
  EXPECT_EQ(problem(file, "mode"),
            "'mode' in run.dat has 'idle' in line 3, which is no finite number");
  EXPECT_EQ(problem(file, "q"), "'q' in run.dat has '[1; 2]' in line 7, which is no finite number");
  EXPECT_EQ(column(file, "a").values, (Values{1, 3}));
  EXPECT_EQ(clock(file, "a").values, (Values{0, 2}));
}

TEST_F(ChangeListTest, RefusesARowWithoutATimeOrAKey) {
  EXPECT_EQ(error("Timestamp,Key,Value\n0,a,1\n0,a\n"),
            "run.dat:3: is no row of a time, a key and a value; complete or remove it");
  EXPECT_EQ(error("Timestamp,Key,Value\n0,a,1\nx,a,1\n"),
            "run.dat:3: is no row of a time, a key and a value; complete or remove it");
  EXPECT_EQ(error("Timestamp,Key,Value\n0,a,1\n0,,1\n"),
            "run.dat:3: has no key; complete or remove the row");
  EXPECT_EQ(error("Timestamp,Key,Value\n"),
            "run.dat: is a list of changes without any; check how it was exported");
}

TEST_F(ChangeListTest, ATableIsNone) {
  EXPECT_FALSE(is_change_list("time,name,value\n0,1,2\n"));
  EXPECT_FALSE(is_change_list("time,key,value,unit\n0,a,1,V\n"));
  EXPECT_FALSE(is_change_list("t,x\n0,1\n"));
  EXPECT_FALSE(is_change_list(""));
}

// The other export of AdvantageScope: a blank is no sample of its column.
TEST_F(ChangeListTest, ABlankInATableIsNoSample) {
  std::string text = "Timestamp,/Arm/Position,/Arm/Volts\n0,,\n";
  for (int i = 1; i <= 30; ++i)
    text += std::to_string(i) + "," + std::to_string(2 * i) + "," +
            (i % 3 == 0 ? std::to_string(5 * i) : "") + "\n";
  const RecordingFile file = read(text);
  Values kept;
  for (const double x : column(file, "/Arm/Volts").values)
    if (x == x) kept.push_back(x);
  EXPECT_EQ(kept, (Values{15, 30, 45, 60, 75, 90, 105, 120, 135, 150}));
  EXPECT_EQ(column(file, "/Arm/Position").values.size(), 31u);
  EXPECT_EQ(column(file, "/Arm/Position").values[30], 60.0);
}

}  // namespace
}  // namespace axisfit
