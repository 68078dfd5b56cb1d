#include "fit/first_look/force_balance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace axisfit {
namespace {

constexpr double kMassOf = 2.0, kDamping = 3.0, kFriction = 1.5, kConstantForce = 0.4;

/// A sine that needs the force of these, exactly.
struct Sine {
  std::vector<double> times, position, velocity, input;

  Sine() {
    for (int i = 0; i < 2000; ++i) {
      const double t = 1e-3 * i, w = 7.0, x = 0.5 * std::sin(w * t), v = 0.5 * w * std::cos(w * t);
      times.push_back(t);
      position.push_back(x);
      velocity.push_back(v);
      input.push_back(-kMassOf * w * w * x + kDamping * v + std::copysign(kFriction, v) +
                      kConstantForce);
    }
  }
  DrivenMotion motion() const { return {times, position, velocity, input}; }
};

/// What the true law leaves of the input, in parts of it.
double left_by_the_truth(bool of_position, double delay, double seen_delay) {
  Sine sine;
  std::vector<double> late(sine.input.size());
  const auto shift = static_cast<std::ptrdiff_t>(std::lround(delay / 1e-3));
  for (std::ptrdiff_t i = 0; i < std::ssize(late); ++i)
    late[static_cast<std::size_t>(i)] = sine.input[static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(i + shift, 0, std::ssize(late) - 1))];
  sine.input = late;
  std::vector<Grid> grids;
  grids.emplace_back(sine.motion(), of_position);
  const Balance balance = balance_in(grids, 64, of_position, {}, seen_delay);
  EXPECT_EQ(balance.terms.cols(), 4);
  EXPECT_GT(balance.terms.rows(), 50);
  const Eigen::Vector4d truth(kMassOf, kDamping, kFriction, kConstantForce);
  const Eigen::VectorXd inputs = balance.inputs(grids, seen_delay);
  return (inputs - balance.terms * truth).norm() / inputs.norm();
}

TEST(ForceBalance, IsZeroForTheTrueLaw) {
  EXPECT_LT(left_by_the_truth(true, 0.0, 0.0), 5e-3);
  EXPECT_LT(left_by_the_truth(false, 0.0, 0.0), 5e-3);
}

// The motion follows what drives it.
TEST(ForceBalance, TakesTheInputSoMuchEarlier) {
  EXPECT_LT(left_by_the_truth(true, 0.01, 0.01), 0.02);
  EXPECT_GT(left_by_the_truth(true, 0.01, 0.0), 0.05);
}

TEST(ForceBalance, WindowsIntegrateByParts) {
  const Window window(40, 0.01);
  double slope = 0.0, bend = 0.0, area = 0.0;
  for (std::size_t i = 0; i < window.value.size(); ++i) {
    const double t = 0.01 * static_cast<double>(i);
    area += window.value[i];
    slope -= window.slope[i] * t;          // of a constant speed
    bend += window.bend[i] * 0.5 * t * t;  // of a constant acceleration
  }
  EXPECT_NEAR(slope, area, 1e-12);
  EXPECT_NEAR(bend, area, 1e-9);
}

}  // namespace
}  // namespace axisfit
