#include "apps/progress.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

namespace axisfit {
namespace {

TEST(Progress, TimeLeftNeedsABasis) {
  EXPECT_FALSE(time_left(0, 0, 10.0));
  EXPECT_FALSE(time_left(0, 40, 10.0));
  EXPECT_FALSE(time_left(1, 40, 10.0));
  EXPECT_FALSE(time_left(40, 40, 10.0));
  EXPECT_DOUBLE_EQ(time_left(10, 40, 20.0).value(), 60.0);
  // It does not run out while a part takes longer than those before.
  EXPECT_GT(time_left(39, 40, 400.0).value(), time_left(39, 40, 39.0).value());
}

TEST(Progress, TimeLeftIsNoFinerThanKnown) {
  EXPECT_EQ(about(0.3), "about 5 s");
  EXPECT_EQ(about(12.0), "about 15 s");
  EXPECT_EQ(about(41.2), "about 40 s");
  EXPECT_EQ(about(57.0), "about 1 min");
  EXPECT_EQ(about(130.0), "about 2 min");
  EXPECT_EQ(about(43.0 * 60.0), "about 45 min");
  EXPECT_EQ(about(119.0 * 60.0), "about 2 h");
  EXPECT_EQ(about(9.6 * 3600.0), "about 10 h");
}

TEST(Progress, ElapsedTimeIsAStopwatch) {
  EXPECT_EQ(stopwatch(0.9), "0:00");
  EXPECT_EQ(stopwatch(65.0), "1:05");
  EXPECT_EQ(stopwatch(7390.0), "2:03:10");
}

TEST(Progress, TellsWhatIsKnown) {
  EXPECT_EQ(progress_text({"reading the recordings"}, 2.0, {}, 80), "reading the recordings  0:02");
  EXPECT_EQ(progress_text({"starts", 12, 40, 0.98654}, 22.0, 51.0, 80),
            "starts  [###.......]  12 of 40 done  about 50 s left  red. chi2 0.9865  0:22");
  EXPECT_EQ(progress_text({"profiles", 40, 40}, 5.0, {}, 80),
            "profiles  [##########]  40 of 40 done  0:05");
}

TEST(Progress, LeavesOutWhatThereIsNoRoomFor) {
  const Progress progress{"trying directional_friction", 3, 8, 87.78};
  EXPECT_EQ(progress_text(progress, 125.0, 40.0, 81),
            "trying directional_friction  3 of 8 done  about 40 s left  red. chi2 87.78  2:05");
  EXPECT_EQ(progress_text(progress, 125.0, 40.0, 80),
            "trying directional_friction  3 of 8 done  about 40 s left  2:05");
  EXPECT_EQ(progress_text(progress, 125.0, 40.0, 40), "trying directional_friction  2:05");
  for (std::size_t width = 1; width < 120; ++width)
    EXPECT_LT(progress_text(progress, 125.0, 40.0, width).size(), width);
  EXPECT_EQ(progress_text(progress, 125.0, 40.0, 0), "");
}

}  // namespace
}  // namespace axisfit
