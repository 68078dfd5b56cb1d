#include "fit/data/jump_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace axisfit {
namespace {

constexpr std::size_t kSamples = 400;

/// To and fro by 0.1 m, once in 0.4 s, every ms.
std::vector<double> swing() {
  std::vector<double> position;
  for (std::size_t i = 0; i < kSamples; ++i)
    position.push_back(0.1 * std::sin(15.0 * 1e-3 * static_cast<double>(i)));
  return position;
}

Recording recorded(std::vector<double> values) {
  Recording recording;
  std::vector<double> times;
  for (std::size_t i = 0; i < values.size(); ++i) times.push_back(1e-3 * static_cast<double>(i));
  recording.times = std::move(times);
  Measurement& position = recording.measurements.emplace_back();
  position.signal = Signal::position;
  position.values = std::move(values);
  return recording;
}

const std::vector<double> kSteady(kSamples, 1.0);

std::optional<Jump> found(std::vector<double> values,
                          const std::vector<double>& command = kSteady) {
  const Recording recording = recorded(std::move(values));
  return jump_of(recording, recording.measurements[0], command);
}

std::vector<double> displaced(std::vector<double> values, std::size_t from, double by) {
  for (std::size_t i = from; i < values.size(); ++i) values[i] += by;
  return values;
}

TEST(JumpCheck, FindsThePlaceAndTheSizeOfOneOrTwo) {
  EXPECT_FALSE(found(swing()));
  const auto one = found(displaced(swing(), 150, -2e-3));
  ASSERT_TRUE(one);
  EXPECT_EQ(one->at, 150u);
  EXPECT_NEAR(one->size, -2e-3, 1e-6);
  const auto two = found(displaced(displaced(swing(), 150, -2e-3), 300, 5e-3));
  ASSERT_TRUE(two);
  EXPECT_EQ(two->at, 300u);
}

TEST(JumpCheck, ABadReadingReturns) {
  std::vector<double> values = swing();
  values[150] += 2e-3;
  EXPECT_FALSE(found(values));
}

TEST(JumpCheck, AnImpactChangesTheSpeed) {
  std::vector<double> values = swing();
  for (std::size_t i = 150; i < kSamples; ++i)
    values[i] = values[149] - 3e-3 * static_cast<double>(i - 149);
  EXPECT_FALSE(found(values));
}

TEST(JumpCheck, ACommandMayMoveAQuickAxisWithinASample) {
  std::vector<double> command = kSteady;
  for (std::size_t i = 149; i < kSamples; ++i) command[i] = 2.0;
  EXPECT_FALSE(found(displaced(swing(), 150, -2e-3), command));
}

TEST(JumpCheck, TellsNothingOfWhatIsMissingBesideIt) {
  const Recording recording = recorded(displaced(swing(), 150, -2e-3));
  Measurement position = recording.measurements[0];
  EXPECT_TRUE(jump_of(recording, position, kSteady));
  position.uninformative.assign(kSamples, false);
  position.uninformative[149] = true;
  EXPECT_FALSE(jump_of(recording, position, kSteady));
}

}  // namespace
}  // namespace axisfit
