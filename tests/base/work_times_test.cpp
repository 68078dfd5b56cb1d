#include "base/work_times.h"

#include <gtest/gtest.h>

#include <cmath>

namespace axisfit {
namespace {

/// Keeps a processor busy for so many seconds of it.
void work_for(double seconds) {
  const std::clock_t begin = std::clock();
  volatile double x = 1.0;
  while (static_cast<double>(std::clock() - begin) < seconds * CLOCKS_PER_SEC)
    for (int i = 0; i < 1000; ++i) x = std::sqrt(x + 1.0);
}

TEST(WorkTimes, GoToWhatWasEntered) {
  WorkTimes watch;
  work_for(0.01);
  watch.enter(Work::scores);
  work_for(0.05);
  watch.enter(Work::trials);
  const auto times = watch.times();
  const auto of = [&](Work work) { return times[static_cast<std::size_t>(work)]; };
  EXPECT_GE(of(Work::fits).processor, 0.01);
  EXPECT_GE(of(Work::scores).processor, 0.05);
  EXPECT_GE(of(Work::scores).wall, 0.9 * of(Work::scores).processor);
  EXPECT_LT(of(Work::trials).processor, of(Work::scores).processor);
  EXPECT_EQ(of(Work::errors).wall, 0.0);
}

}  // namespace
}  // namespace axisfit
