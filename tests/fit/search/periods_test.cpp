#include "fit/search/periods.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

constexpr std::size_t kSamples = 4000;
constexpr double kStroke = 1.0;  // m
constexpr double kSigma = 0.05;  // m/s^2

/// One stroke at an even speed, seen by an accelerometer, which shows a force on a free unit mass
/// as it is. The drive's force reverses ten times.
class PeriodsTest : public testing::Test {
 protected:
  PeriodsTest() {
    recording_.times = instants(kSamples - 1, 1e-3);
    Measurement& m = recording_.measurements.emplace_back();
    m.signal = Signal::acceleration;
    m.sigma = kSigma;
    m.values.edit().assign(kSamples, 0.0);
    for (std::size_t i = 0; i < kSamples; ++i) {
      Sample& sample = prediction_.samples.emplace_back();
      sample.position = kStroke * static_cast<double>(i) / (kSamples - 1);
      sample.velocity = kStroke / (1e-3 * (kSamples - 1));
      sample.drive_force = i / 400 % 2 == 0 ? 40.0 : -40.0;
    }
  }
  /// What a force of this period (m) leaves of the acceleration.
  Eigen::VectorXd residuals(double period, bool of_drive) const {
    Eigen::VectorXd r(kSamples);
    for (std::size_t i = 0; i < kSamples; ++i) {
      const Sample& s = prediction_.samples[i];
      const double force = of_drive ? 0.03 * s.drive_force : 1.2;
      r[static_cast<Eigen::Index>(i)] =
          force * std::sin(2.0 * std::numbers::pi * s.position / period + 0.7) / kSigma;
    }
    return r;
  }
  std::vector<double> found(const Eigen::VectorXd& residuals, bool of_drive,
                            const Eigen::MatrixXd& basis = Eigen::MatrixXd(kSamples, 0)) const {
    return periods_in(recording_, prediction_, {}, residuals, basis, 3, of_drive);
  }

  Recording recording_;
  SimulatedRecording prediction_;
};

// Whole numbers of quarter cycles over the stroke are looked at.
TEST_F(PeriodsTest, OfAForceAreFound) {
  for (const double cycles : {5.0, 12.5, 60.25, 640.25})
    EXPECT_NEAR(found(residuals(kStroke / cycles, false), false).front(), kStroke / cycles, 1e-9);
}

TEST_F(PeriodsTest, AreNoLongerThanTheStroke) {
  for (const double period : found(residuals(1.7 * kStroke, false), false))
    EXPECT_LE(period, kStroke);
}

TEST_F(PeriodsTest, OfARippleAreFoundInProportionToTheDrive) {
  for (const double cycles : {7.0, 12.5, 60.25}) {
    const Eigen::VectorXd r = residuals(kStroke / cycles, true);
    EXPECT_NEAR(found(r, true).front(), kStroke / cycles, 1e-9);
    // To a force that knows nothing of the drive it is sidebands.
    EXPECT_GT(std::abs(found(r, false).front() - kStroke / cycles), 1e-3);
  }
}

TEST_F(PeriodsTest, LeaveOutWhatParametersExplain) {
  const Eigen::VectorXd known = residuals(kStroke / 5.0, false);
  const Eigen::VectorXd sum = 3.0 * known + residuals(kStroke / 20.0, false);
  EXPECT_NEAR(found(sum, false).front(), kStroke / 5.0, 1e-9);
  EXPECT_NEAR(found(sum, false, known.normalized()).front(), kStroke / 20.0, 1e-9);
}

TEST_F(PeriodsTest, AreAsManyAsAskedForAndNoneWithoutMotion) {
  EXPECT_EQ(found(residuals(kStroke / 5.0, false), false).size(), 3u);
  for (Sample& s : prediction_.samples) s.position = 0.3, s.velocity = 0.0;
  EXPECT_TRUE(found(residuals(kStroke / 5.0, false), false).empty());
}

}  // namespace
}  // namespace axisfit
