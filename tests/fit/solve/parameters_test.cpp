#include "fit/solve/parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/fit/parameter_ids.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

/// On a linear scale, without bounds.
FreeParameter linear(const char* name, double initial) {
  FreeParameter p = free_parameter(name, initial);
  p.scale = Scale::linear;
  p.lower = -std::numeric_limits<double>::infinity();
  p.upper = std::numeric_limits<double>::infinity();
  return p;
}

/// A mass on a logarithmic scale, a damping on a linear one, and a gain that is the second
/// recording's own. That recording has an inertia and a gain that are not the model's.
Job two_machines() {
  Job job;
  job.model = driven_mass(20.0);
  job.recordings.resize(2);
  job.recordings[1].overrides = {{quantity_index("J_m"), 1e-3}, {quantity_index("K_f"), 9.0}};
  job.free = {free_parameter("M", 10.0), linear("B_a", -4.0), free_parameter("K_f", 2.0)};
  job.free[2].recording = 1;
  return job;
}

constexpr double kM = 12.0, kB_a = 6.0, kK_f = 3.0;

/// All quantities of a recording's model.
std::vector<double> quantities(const Job& job, std::span<const double> values,
                               std::size_t recording) {
  const ParameterSpace space(job);
  Model<double> model = model_at(job, space, space.internal(values).data(), recording);
  std::vector<double> list;
  for (const double* member : members(model)) list.push_back(*member);
  return list;
}

TEST(ParameterSpace, IsLogarithmicOrRelativeToTheMagnitude) {
  const Job job = two_machines();
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal({{kM, kB_a, kK_f}});
  EXPECT_DOUBLE_EQ(u[0], std::log(kM));
  EXPECT_DOUBLE_EQ(u[1], kB_a / 4.0);
  EXPECT_DOUBLE_EQ(u[2], std::log(kK_f));
  const std::vector<double> values = space.values(u);
  EXPECT_DOUBLE_EQ(values[0], kM);
  EXPECT_DOUBLE_EQ(values[1], kB_a);
  EXPECT_DOUBLE_EQ(values[2], kK_f);
}

// Far above a hundredth of the initial value a step is a part of the value; at zero it is an
// amount.
TEST(ParameterSpace, FromZeroReachesZero) {
  Job job;
  job.free = {free_parameter("B_a", 50.0)};
  ASSERT_EQ(job.free[0].scale, Scale::from_zero);
  const ParameterSpace space(job);
  EXPECT_EQ(space.internal(0, 0.0), 0.0);
  EXPECT_EQ(space.value(0, 0.0), 0.0);
  EXPECT_EQ(space.slope(0, 0.0), 0.5);
  EXPECT_NEAR(space.internal(0, 50.0 * std::exp(1.0)) - space.internal(0, 50.0), 1.0, 1e-4);
  for (const double value : {0.0, 1e-3, 0.5, 50.0, 1e6})
    EXPECT_NEAR(space.value(0, space.internal(0, value)), value, 1e-12 * (1.0 + value));
}

TEST(ParameterSpace, NoBoundIsOutOfReach) {
  std::vector<FreeParameter> free{free_parameter("B_a", 1e-300), free_parameter("M", 10.0),
                                  free_parameter("B_a", 50.0)};
  const ParameterSpace space(free);
  for (std::size_t i = 0; i < free.size(); ++i)
    for (const double bound : {free[i].lower, free[i].upper})
      EXPECT_EQ(space.value(i, space.internal(i, bound)), bound) << i;
}

TEST(ParameterSpace, SlopeIsThatOfDifferences) {
  const Job job = two_machines();
  const ParameterSpace space(job);
  constexpr double kStep = 1e-5;  // whose square is the relative error
  for (std::size_t i = 0; i < space.size(); ++i) {
    const double slope = (space.value(i, 0.7 + kStep) - space.value(i, 0.7 - kStep)) / (2 * kStep);
    EXPECT_NEAR(space.slope(i, 0.7), slope, 1e-9 * std::abs(slope)) << i;
  }
}

TEST(ParameterSpace, AZeroStartTakesItsMagnitudeFromTheBounds) {
  std::vector<FreeParameter> free{linear("B_a", 0.0), linear("B_a", 0.0)};
  free[0].lower = -100.0;
  free[0].upper = 300.0;
  const ParameterSpace space(free);
  EXPECT_DOUBLE_EQ(space.value(0, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(space.value(1, 1.0), 1.0);  // unbounded: any will do
}

TEST(ParameterSpace, AParameterOfOneRecordingAppliesThereAlone) {
  const Job job = two_machines();
  const ParameterSpace space(job);
  EXPECT_TRUE(space.applies(0, 0) && space.applies(0, 1));
  EXPECT_FALSE(space.applies(2, 0));
  EXPECT_TRUE(space.applies(2, 1));
}

TEST(ModelAt, AFreeParameterOverridesTheRecordingWhichOverridesTheModel) {
  const Job job = two_machines();
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal({{kM, kB_a, kK_f}});
  const Axis<double> first = model_at(job, space, u.data(), 0).axis;
  EXPECT_DOUBLE_EQ(first.M, kM);
  EXPECT_DOUBLE_EQ(first.B_a, kB_a);
  EXPECT_EQ(first.J_m, job.model.axis.J_m);
  EXPECT_EQ(first.K_f, job.model.axis.K_f);
  const Axis<double> second = model_at(job, space, u.data(), 1).axis;
  EXPECT_DOUBLE_EQ(second.M, kM);
  EXPECT_EQ(second.J_m, 1e-3);
  EXPECT_DOUBLE_EQ(second.K_f, kK_f);
}

TEST(FixedAt, LeavesNothingFreeAndEveryModelAsItWas) {
  Job job = two_machines();
  job.recordings[0].overrides = {{quantity_index("M"), 1.0}};
  const ParameterSpace space(job);
  // As the space has them, rounding included.
  const std::vector<double> values = space.values(space.internal({{kM, kB_a, kK_f}}));
  const Job fixed = fixed_at(job, values);
  EXPECT_TRUE(fixed.free.empty());
  for (const std::size_t recording : {0u, 1u})
    EXPECT_EQ(quantities(fixed, {}, recording), quantities(job, values, recording)) << recording;
}

TEST(InitialValues, StayWithinTheBounds) {
  Job job = two_machines();
  EXPECT_EQ(initial_values(job), (std::vector{10.0, -4.0, 2.0}));
  job.free[0].upper = 30.0;
  set_initial_values(job, {{50.0, 7.0}});
  EXPECT_EQ(initial_values(job), (std::vector{30.0, 7.0, 2.0}));
}

}  // namespace
}  // namespace axisfit
