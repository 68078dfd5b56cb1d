#include "io/config/axis_file.h"
#include "sim/rig.h"
#include "tests/sim/stress.h"

namespace axisfit {
namespace {

TEST(StressSlowTest, AnyAxisEndsInFiniteReadingsOrIsGivenUp) { expect_endured(300, 10'000); }

TEST(StressSlowTest, HalfAMillionEventsInARowDoNotChatter) {
  // One event in a hundred thousand leaves the guard behind it below zero by rounding, and rising,
  // to fall again within the next step.
  Diagnostics diagnostics;
  const Rig rig = *read_axis_file(AXISFIT_CONFIGS "/axes/x.yaml", diagnostics);
  RecordingOptions options;
  options.duration = 10'000.0;
  EXPECT_EQ(record(rig, PrbsMotion{2.0, 0.2}, options).front().values.size(), 10'000'001u);
}

}  // namespace
}  // namespace axisfit
