#include "fit/couplings.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/sim/axes.h"

namespace axisfit {
namespace {

/// A run that found this force per acceleration of another axis, in a unit of that.
AxisRun run_of(const std::string& name, const std::string& channel, const std::string& unit,
               double value, double error, Joint joint = Joint::prismatic) {
  AxisRun axis;
  axis.name = name;
  Job& job = axis.result.baseline;
  job.model = driven_mass(10.0);
  job.model.structure.joint = joint;
  job.model.structure.channels = kept({{"temperature", "degC", 0.0}, {channel, unit, 0.0}});
  add_effect<ChannelForce>(job.model).k[1] = value;
  std::size_t index = 0;
  for (const QuantityEntry& entry : quantity_list())
    if (entry.group == "channel_force" && entry.quantity.channel == std::size_t{1})
      index = entry.index;
  job.free.push_back(free_parameter(quantity_list()[index], value));
  FitResult& fit = axis.result.first;
  fit.verdict.kind = FitVerdict::Kind::usable;
  ParameterResult found;
  found.value = value;
  found.uncertainty.determined = true;
  found.uncertainty.standard_error = error;
  fit.parameters.push_back(found);
  return axis;
}

TEST(SharedInertia, IsTheWeightedMeanOfBothAxes) {
  const std::vector<SharedInertia> found =
      shared_inertias({run_of("x", "y_acceleration", "mm/s^2", -2.2e-4, 3e-6),
                       run_of("y", "x_acceleration", "m/s^2", -0.225, 0.004)});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].one, "x");
  EXPECT_EQ(found[0].other, "y");
  EXPECT_EQ(found[0].unit, "kg");
  EXPECT_NEAR(found[0].from_one.value, 0.22, 1e-12);
  EXPECT_NEAR(found[0].from_one.error, 0.003, 1e-12);
  EXPECT_NEAR(found[0].both.value, (0.22 / 9.0 + 0.225 / 16.0) / (1.0 / 9.0 + 1.0 / 16.0), 1e-12);
  EXPECT_NEAR(found[0].both.error, 0.0024, 1e-12);
  EXPECT_NEAR(found[0].apart, 1.0, 1e-12);
}

TEST(SharedInertia, HasWiderErrorsWhereTheAxesDisagree) {
  const auto found = shared_inertias({run_of("x", "y_acceleration", "m/s^2", -0.20, 0.003),
                                      run_of("y", "x_acceleration", "m/s^2", -0.25, 0.004)});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].apart, 10.0, 1e-9);
  EXPECT_NEAR(found[0].both.error, 0.024, 1e-9);
}

TEST(SharedInertia, OfAJointAndASlideHasItsOwnUnit) {
  const auto found =
      shared_inertias({run_of("x", "wrist_acceleration", "rad/s^2", -0.35, 0.01),
                       run_of("wrist", "x_acceleration", "m/s^2", -0.36, 0.01, Joint::revolute)});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].unit, "kg m");
}

TEST(SharedInertia, NeedsBothAxes) {
  const AxisRun x = run_of("x", "y_acceleration", "m/s^2", -0.2, 0.01);
  EXPECT_TRUE(shared_inertias({x, run_of("y", "z_acceleration", "m/s^2", -0.2, 0.01)}).empty());
  EXPECT_TRUE(shared_inertias({x, run_of("y", "x_position", "m", -0.2, 0.01)}).empty());
  AxisRun unknown = run_of("y", "x_acceleration", "m/s^2", -0.2, 0.01);
  unknown.result.first.parameters[0].uncertainty.determined = false;
  EXPECT_TRUE(shared_inertias({x, unknown}).empty());
}

}  // namespace
}  // namespace axisfit
