#include "fit/design/discrimination.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// A free mass that a constant force of 40 N moved by 0.25 m in 0.5 s, seen by its velocity; and
/// two models of it that the readings of one sensor tell apart.
class DiscriminationTest : public testing::Test {
 protected:
  DiscriminationTest() {
    model_ = driven_mass(20.0);
    model_.axis.K_f = 40.0;
    Job& job = selection_.result.job;
    job.model = model_;
    job.options.threads = 1;
    job.recordings = {recorded(model_, StepMotion{1.0, 0.0}, 0.5, 1, {Signal::velocity})};
    selection_.result.fit = result_at_start(job);
  }
  Discrimination advice(Signal signal, double bias, const MachineLimits& limits) {
    Substitution rivals{"this", "that", model_, model_};
    rivals.with_rival.instruments[index_of(signal)].bias = bias;
    selection_.result.job.limits = limits;
    return discriminate(selection_, rivals, true);
  }

  /// No motion keeps to these: only those that were recorded are left.
  static constexpr MachineLimits kNone{0.0, 0.0, 1e-9, 1.0};

  Model<double> model_;
  EffectSelection selection_;
};

// Without a known noise it is a thousandth of the range, here 0.25 mm.
TEST_F(DiscriminationTest, IsTheDifferenceInUnitsOfTheNoise) {
  const Discrimination found = advice(Signal::position, -1e-3, kNone);
  ASSERT_TRUE(found.signal);
  EXPECT_EQ(*found.signal, Signal::position);
  EXPECT_FALSE(found.experiment);
  EXPECT_NEAR(found.size, 4.0, 1e-6);
  EXPECT_EQ(found.chosen, "this");
  EXPECT_EQ(found.rival, "that");
  EXPECT_EQ(found.recording, "fit");
}

TEST_F(DiscriminationTest, IsNotSoughtInWhatWasRecorded) {
  const Discrimination none = advice(Signal::velocity, 0.1, kNone);
  EXPECT_FALSE(none.signal);
  EXPECT_EQ(none.size, 0.0);
  EXPECT_EQ(none.recording, "");
  // Another motion may show it: there the noise of the recorded signal counts.
  const Discrimination other = advice(Signal::velocity, 0.1, {-1.0, 1.0, 2.0, 1.0});
  ASSERT_TRUE(other.signal && other.experiment);
  EXPECT_EQ(*other.signal, Signal::velocity);
  EXPECT_NEAR(other.size, 0.1 / usual_noise(Signal::velocity), 1e-6);
  EXPECT_EQ(other.recording, "");
}

TEST_F(DiscriminationTest, OfLessThanATenthOfTheNoiseIsNone) {
  EXPECT_FALSE(advice(Signal::position, 0.09 * 2.5e-4, kNone).signal);
  EXPECT_TRUE(advice(Signal::position, 0.11 * 2.5e-4, kNone).signal);
}

}  // namespace
}  // namespace axisfit
