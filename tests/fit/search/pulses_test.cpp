#include "fit/search/pulses.h"

#include <gtest/gtest.h>

#include <random>

#include "fit/search/force_response.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

constexpr std::size_t kSamples = 2000;
constexpr double kInterval = 2e-3;  // s
constexpr Observer kObserver{.velocity = 40.0, .position = 20.0, .acceleration = 400.0};

/// The velocity of an axis that is pushed, with noise.
class PulsesTest : public testing::Test {
 protected:
  PulsesTest() {
    recording_.times = instants(kSamples - 1, kInterval);
    Measurement& m = recording_.measurements.emplace_back();
    m.signal = Signal::velocity;
    m.sigma = 1e-3;
    m.values.edit().assign(kSamples, 0.0);
  }
  /// The residuals that a push (N, on 1 kg) of `length` s leaves, without noise.
  Eigen::VectorXd push(double start, double length, double force) const {
    std::vector<double> forces(kSamples, 0.0);
    for (std::size_t i = 0; i < kSamples; ++i)
      if (recording_.times[i] >= start && recording_.times[i] < start + length) forces[i] = force;
    return response_to(recording_, forces, kObserver);
  }
  static Eigen::VectorXd noise() {
    std::mt19937_64 engine(7);
    std::normal_distribution<double> normal;
    return Eigen::VectorXd::NullaryExpr(kSamples, [&] { return normal(engine); });
  }
  std::vector<Pulse> found(const Eigen::VectorXd& residuals,
                           const Eigen::MatrixXd& basis = Eigen::MatrixXd(kSamples, 0)) const {
    return pulses_in(recording_, kObserver, residuals, basis, 2);
  }
  static void expect_is(const Pulse& pulse, double start, double length) {
    EXPECT_NEAR(pulse.start, start, 0.15 * length);
    EXPECT_NEAR(pulse.end, start + length, 0.15 * length);
  }

  Recording recording_;
};

TEST_F(PulsesTest, AreFoundWithTheirEdges) {
  for (const double length : {0.03, 0.17, 0.6})
    for (const double start : {0.2, 1.31, 3.1})
      expect_is(found(push(start, length, 4.0) + noise()).front(), start, length);
}

TEST_F(PulsesTest, AreTheLargestThatDoNotOverlap) {
  const std::vector<Pulse> pulses = found(push(0.5, 0.2, 6.0) + push(2.5, 0.1, -4.0) + noise());
  ASSERT_EQ(pulses.size(), 2u);
  expect_is(pulses[0], 0.5, 0.2);
  expect_is(pulses[1], 2.5, 0.1);
  EXPECT_GT(pulses[0].gain, pulses[1].gain);
}

TEST_F(PulsesTest, LeaveOutWhatParametersExplain) {
  const Eigen::VectorXd known = push(0.5, 0.2, 6.0);
  expect_is(found(known + push(2.5, 0.1, -4.0) + noise(), known.normalized()).front(), 2.5, 0.1);
}

// All that the push leaves is explained, and of noise next to nothing.
TEST_F(PulsesTest, SayHowMuchTheyExplain) {
  const Eigen::VectorXd residuals = push(1.0, 0.2, 4.0);
  EXPECT_GT(found(residuals).front().gain, 0.95 * residuals.squaredNorm());
  EXPECT_LT(found(noise()).front().gain, 30.0);
}

TEST_F(PulsesTest, AreNotSoughtInAFewSamples) {
  recording_.times.edit().resize(20);
  recording_.measurements.front().values.edit().resize(20);
  EXPECT_TRUE(pulses_in(recording_, kObserver, Eigen::VectorXd::Ones(20), Eigen::MatrixXd(20, 0), 2)
                  .empty());
}

}  // namespace
}  // namespace axisfit
