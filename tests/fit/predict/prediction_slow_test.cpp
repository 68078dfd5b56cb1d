#include <gtest/gtest.h>

#include "fit/predict/prediction.h"
#include "tests/fit/predicted.h"

namespace axisfit {
namespace {

TEST(PredictionSlowTest, BandsHoldWhatWasNotFitted) {
  constexpr int kMachines = 20;
  double inside = 0.0;
  int whole = 0;
  for (std::uint64_t seed = 1; seed <= kMachines; ++seed) {
    const RunResult result = predicted(0.05, seed);
    ASSERT_EQ(result.predictions.size(), 1u);
    const RecordingPrediction& prediction = result.predictions.front();
    EXPECT_EQ(prediction.recording, 5u);
    EXPECT_EQ(prediction.draws, AxisEnsemble::kDraws);
    ASSERT_EQ(prediction.signals.size(), 1u);
    inside += prediction.signals.front().inside_percent / kMachines;
    whole += prediction.signals.front().is_whole_inside;
  }
  EXPECT_GE(inside, 87.0);  // 95 of as many cases, with two standard deviations
  EXPECT_GE(whole, 16);
}

}  // namespace
}  // namespace axisfit
