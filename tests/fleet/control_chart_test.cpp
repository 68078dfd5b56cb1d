#include "fleet/control_chart.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/base/noise.h"

namespace axisfit {
namespace {

TEST(Cusum, RunLengthIsThatOfTheLiterature) {
  // D. C. Montgomery, Introduction to Statistical Quality Control, table of two-sided charts with
  // k = 0.5: 168 for h = 4, 465 for h = 5.
  EXPECT_NEAR(mean_run_length(4.0, 0.5), 168.0, 1.0);
  EXPECT_NEAR(mean_run_length(5.0, 0.5), 465.0, 2.0);
  EXPECT_NEAR(mean_run_length(threshold_for(1000.0)), 1000.0, 1.0);
}

TEST(Cusum, AlarmsAsOftenAsItsThresholdSays) {
  Normal normal(1);
  Cusum chart(threshold_for(200.0));
  int alarms = 0;
  constexpr int kNights = 200'000;
  constexpr double kExpected = kNights / 200.0;
  for (int i = 0; i < kNights; ++i)
    if (chart.add(normal())) {
      ++alarms;
      chart.restart();
    }
  EXPECT_NEAR(alarms, kExpected, 4.0 * std::sqrt(kExpected));
}

TEST(Cusum, TellsTheDirectionAndSinceWhen) {
  Cusum chart(3.0);
  EXPECT_FALSE(chart.add(0.0));
  EXPECT_EQ(chart.nights_since(), 0u);
  EXPECT_FALSE(chart.add(-2.25));  // 1.5 below the reference
  EXPECT_EQ(chart.direction(), -1);
  EXPECT_TRUE(chart.add(-2.25)) << "3.0 is reached";
  EXPECT_EQ(chart.nights_since(), 2u);
  chart.restart();
  EXPECT_FALSE(chart.add(-2.25));
}

TEST(Cusum, ForgetsWhatIsBelowItsReference) {
  Cusum chart(3.0);
  for (int night = 0; night < 100; ++night) EXPECT_FALSE(chart.add(kChartReference)) << night;
  chart.add(2.0);
  chart.add(0.0);
  chart.add(-0.75);
  EXPECT_EQ(chart.nights_since(), 0u);
}

}  // namespace
}  // namespace axisfit
