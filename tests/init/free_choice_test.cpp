#include "init/free_choice.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tests/init/made_job.h"

namespace axisfit {
namespace {

using FreeChoiceTest = InitJobTest;

TEST_F(FreeChoiceTest, WhatTheRecordingsLeaveOpenIsNotFree) {
  make({AXISFIT_TESTDATA "/clean-slow.csv"}, AXISFIT_CONFIGS "/axes/x.yaml");
  EXPECT_EQ(folder_.names(), (std::set<std::string>{"job.yaml"}));
  const std::string text = folder_.read("job.yaml");
  EXPECT_NE(text.find("\n  # V_L: {}   not free: no recorded signal depends on it"),
            std::string::npos)
      << text;
  for (const FreeParameter& p : read().job.free) EXPECT_NE(quantity_list()[p.quantity].name, "V_L");
}

// Twenty samples at 10 Hz are more than a dead time may be.
TEST_F(FreeChoiceTest, SlowSamplesGoWithADelay) {
  make({AXISFIT_TESTDATA "/contact/ten-hertz.csv"});
  const auto found = fitted(read());
  // Straight lines between samples so far apart are a fifth off what drove the axis.
  EXPECT_NEAR(found.at("M"), 200.0, 40.0);
  EXPECT_NEAR(found.at("B_a"), 300.0, 60.0);
}

}  // namespace
}  // namespace axisfit
