#include "io/recording/halscope_file.h"

#include "tests/io/recording/kind_fixture.h"

namespace axisfit {
namespace {

using HalscopeTest = KindTest;

TEST_F(HalscopeTest, NamesMayStandAboveTheValues) {
  const RecordingFile file = read(
      "# Sampling period is 1000000 ns\njoint.0.pos-fb;pid.x.output\n"
      "# Position: 0.500000;0.500000\n# Scale: 0;3\n0.10000000000000;-1.5\n0.2;2.5\n");
  ASSERT_EQ(file.columns().size(), 3u);
  EXPECT_EQ(column(file, "time").values, (Values{0.0, 0.001}));
  EXPECT_EQ(column(file, "time").unit, "s");
  EXPECT_EQ(column(file, "joint.0.pos-fb").values, (Values{0.1, 0.2}));
  EXPECT_EQ(column(file, "pid.x.output").values, (Values{-1.5, 2.5}));
  EXPECT_TRUE(file.where(1).ends_with("run.dat:6"));
}

TEST_F(HalscopeTest, NamesMayStandBeforeEveryValue) {
  // The last row is one more than was recorded.
  const RecordingFile file = read(
      "Sampling period is 2000000 nSec \n\npos +0.10000000000000 out -1.50000000000000 \n"
      "pos +0.2 out +2.5 \npos +7.0 out +7.0 ");
  EXPECT_EQ(column(file, "time").values, (Values{0.0, 0.002}));
  EXPECT_EQ(column(file, "pos").values, (Values{0.1, 0.2}));
  EXPECT_EQ(column(file, "out").values, (Values{-1.5, 2.5}));
}

TEST_F(HalscopeTest, RefusesALineThatIsNoSample) {
  const std::string begun = "# Sampling period is 1000000 ns\na;b\n1;2\n";
  EXPECT_EQ(error(begun + "1\n"),
            "run.dat:4: has 1 values for 2 channels; remove the row, or save the log again");
  EXPECT_EQ(error(begun + "1;inf\n"),
            "run.dat:4: 'inf' is no finite number; remove the row, or save the log again");
  EXPECT_EQ(error("# Sampling period is x ns\na;b\n1;2\n"),
            "run.dat:1: the sampling period is no number of ns; save the log again");
  EXPECT_EQ(error("# Sampling period is 1000 ns\na;b\n"),
            "run.dat: is a log of halscope without samples; record, and save it again");
}

}  // namespace
}  // namespace axisfit
