#include "fit/data/criterion.h"

#include <gtest/gtest.h>

#include "fit/data/job.h"

namespace axisfit {
namespace {

TEST(Criterion, IsAFreeRunByDefault) {
  EXPECT_EQ(FitOptions().criterion, Criterion(FreeRun{}));
  EXPECT_TRUE(FitOptions().is_continued());
}

TEST(Criterion, IsEqualWithTheSameNumbersAlone) {
  const Criterion half = Windows{0.5};
  EXPECT_EQ(half, Criterion(Windows{0.5}));
  EXPECT_NE(half, Criterion(Windows{0.6}));
  EXPECT_NE(half, Criterion(Tracking{0.5}));
  EXPECT_NE(Criterion(Tracking{0.5}), Criterion(Tracking{0.6}));
  EXPECT_EQ(Criterion(FreeRun{}), Criterion(FreeRun{}));
}

TEST(Criterion, HasALengthOfWindowsOrAGainOfTheObserver) {
  const Criterion windows = Windows{0.5}, tracking = Tracking{60.0};
  EXPECT_EQ(window_length(windows), 0.5);
  EXPECT_EQ(given_gain(windows), 0.0);
  EXPECT_FALSE(tracks(windows));
  EXPECT_EQ(window_length(tracking), 0.0);
  EXPECT_EQ(given_gain(tracking), 60.0);
  EXPECT_TRUE(tracks(tracking));
  EXPECT_FALSE(tracks(FreeRun{}));
}

// Whether it was given or chosen, and whatever it was before.
TEST(Criterion, TakesNoContinuationWhileItTracks) {
  FitOptions options;
  options.criterion = Tracking{60.0};
  EXPECT_FALSE(options.is_continued());
  options.criterion = Windows{0.5};
  EXPECT_TRUE(options.is_continued());
  options.continuation.reset();
  EXPECT_FALSE(options.is_continued());
}

}  // namespace
}  // namespace axisfit
