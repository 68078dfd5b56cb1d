#include "sim/rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/sim/rigs.h"

namespace axisfit {
namespace {

/// With a noisy velocity.
Rig rig() {
  Rig rig = rig_of_mass();
  rig.noise[index_of(Signal::velocity)] = 0.01;
  return rig;
}

RecordingOptions options(std::vector<Signal> signals) {
  return one_second(100.0, std::move(signals));
}

constexpr StepMotion kStep{20.0, 0.305};

TEST(ColumnName, IsInPlainLetters) {
  EXPECT_EQ(column_name(Signal::velocity, {}), "velocity_mps");
  EXPECT_EQ(column_name(Signal::acceleration, {}), "acceleration_mps2");
  EXPECT_EQ(column_name(Signal::motor_voltage, {}), "V_m_v");
  EXPECT_EQ(column_name(Signal::velocity, {Joint::revolute}), "velocity_radps");
  EXPECT_EQ(column_name("torque", "N m"), "torque_nm");
}

TEST(Record, HasTimesCommandAndSignalsInTheirOrder) {
  RecordingOptions exact = options({Signal::acceleration, Signal::velocity});
  exact.noise = false;
  const std::vector<Column> columns = record(rig(), kStep, exact);
  ASSERT_EQ(columns.size(), 4u);
  EXPECT_EQ(columns[0].name, "time_s");
  EXPECT_EQ(columns[1].name, "command_v");
  EXPECT_EQ(columns[2].name, "acceleration_mps2");
  EXPECT_EQ(columns[3].name, "velocity_mps");
  ASSERT_EQ(columns[0].values.size(), 101u);
  EXPECT_EQ(columns[0].values.back(), 1.0);
  EXPECT_EQ(columns[1].values[30], 0.0);  // 0.30 s, before the step
  EXPECT_EQ(columns[1].values[31], 20.0);
  EXPECT_NEAR(columns[2].values[50], 2.0, 1e-9);
  EXPECT_NEAR(columns[3].values[100], 2.0 * 0.695, 1e-9);
}

TEST(Record, HasTheNoiseOfTheRigAndOfTheSeed) {
  RecordingOptions noisy = options({Signal::velocity});
  noisy.rate = 5000.0;
  const auto velocity = [&] { return record(rig(), kStep, noisy)[2].values; };
  const std::vector<double> values = velocity();
  double square = 0.0;
  for (std::size_t i = 0; i < 1500; ++i) square += values[i] * values[i] / 1500.0;  // at rest
  EXPECT_NEAR(std::sqrt(square), 0.01, 4.0 * 0.01 / std::sqrt(2.0 * 1500.0));
  EXPECT_EQ(velocity(), values);
  noisy.seed = 2;
  EXPECT_NE(velocity(), values);
}

// Every signal has a stream of its own: others beside it leave its noise alone.
TEST(Record, OtherSignalsLeaveTheNoiseAlone) {
  const std::vector<double> alone = record(rig(), kStep, options({Signal::velocity}))[2].values;
  EXPECT_EQ(record(rig(), kStep, options({Signal::position, Signal::velocity}))[3].values, alone);
}

TEST(Record, APositionHasTheStepsOfItsEncoder) {
  Rig coarse = rig();
  coarse.model.controller.timing.counts_per_revolution = 1000.0;
  const double step = 2.0 * M_PI * motor_radius(coarse.model) / 1000.0;
  RecordingOptions counted = options({Signal::position});
  bool moved = false;
  for (const double x : record(coarse, kStep, counted)[2].values) {
    EXPECT_NEAR(x / step, std::round(x / step), 1e-6);
    moved = moved || x != 0.0;
  }
  EXPECT_TRUE(moved);
  counted.noise = false;
  const double last = record(coarse, kStep, counted)[2].values.back();
  EXPECT_NEAR(last, 0.5 * 2.0 * 0.695 * 0.695, 1e-9);
}

TEST(Record, SaysWhereAMotionEnds) {
  Rig wrong = rig();
  wrong.model.axis.M = 1e-300;
  wrong.model.axis.K_f = 1e300;
  try {
    record(wrong, kStep, options({Signal::velocity}));
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("the motion cannot be simulated beyond 0.30"))
        << error.what();
  }
}

}  // namespace
}  // namespace axisfit
