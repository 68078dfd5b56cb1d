#include <gtest/gtest.h>

#include <cmath>

#include "report/text/report_text.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

TEST(HorizonText, NamesTheCriterion) {
  EXPECT_EQ(horizon_name(Tracking{100.0}), "one step ahead, observer gain 100 1/s");
  EXPECT_EQ(horizon_name(Windows{0.125}), "windows of 0.125 s");
  EXPECT_EQ(horizon_name(FreeRun{}), "whole recordings");
}

TEST(HorizonText, SetsWhatWasTriedSideBySide) {
  RunResult run_result;
  EXPECT_EQ(horizon_text(run_result), "");
  run_result.horizon = HorizonChoice{
      4, 1.25, {{Tracking{100.0}, 0.5}, {Windows{0.25}, 0.04321}, {FreeRun{}, INFINITY}}, 1};
  const std::string text = horizon_text(run_result);
  EXPECT_EQ(on_one_line(text),
            "Horizon of the fit, chosen on 4 stretches of up to 1.25 s error one step ahead, "
            "observer gain 100 1/s 50 % windows of 0.25 s 4.32 % chosen whole recordings not "
            "simulated Free-running error on stretches of the fitted recordings that were left out "
            "in turn, in standard deviations of the signals.");
  expect_narrow(text);
}

}  // namespace
}  // namespace axisfit
