#include "exports/fmu/axis_unit.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "tests/base/message_of.h"
#include "tests/sim/axes.h"

namespace axisfit {
namespace {

constexpr std::uint32_t kPosition = kStateVariables, kVelocity = kStateVariables + 1;

std::uint32_t reference_of(const char* quantity) {
  return kQuantityVariables + static_cast<std::uint32_t>(quantity_index(quantity));
}

/// A mass of 2 kg that the command pushes, 1 N per volt.
AxisUnit mass() {
  Model<double> model = driven_mass(2.0);
  model.axis.K_f = 1.0;
  return AxisUnit(model);
}

TEST(AxisUnit, InputsHoldUntilTheyAreSetAgain) {
  AxisUnit unit = mass();
  unit.set(kCommandVariable, 4.0);
  unit.step(0.0, 0.5);
  unit.step(0.5, 0.5);
  EXPECT_NEAR(unit.value(kVelocity), 2.0, 1e-12);
  EXPECT_NEAR(unit.value(kPosition), 1.0, 1e-12);
  unit.set(kCommandVariable, 0.0);
  unit.step(1.0, 1.0);
  EXPECT_NEAR(unit.value(kVelocity), 2.0, 1e-12);
  EXPECT_EQ(unit.time(), 2.0);
}

TEST(AxisUnit, ACommandActsAfterTheDeadTime) {
  AxisUnit unit = mass();
  unit.set(reference_of("T_d"), 0.25);
  unit.set(kCommandVariable, 4.0);
  unit.step(0.0, 1.0);
  EXPECT_NEAR(unit.value(kVelocity), 2.0 * 0.75, 1e-12);
}

TEST(AxisUnit, QuantitiesCanChangeInMotion) {
  AxisUnit unit = mass();
  unit.set(kCommandVariable, 4.0);
  unit.step(0.0, 1.0);
  unit.set(reference_of("M"), 4.0);
  unit.step(1.0, 1.0);
  EXPECT_NEAR(unit.value(kVelocity), 3.0, 1e-12);
  unit.reset();
  EXPECT_EQ(unit.value(reference_of("M")), 2.0);
  EXPECT_EQ(unit.value(kVelocity), 0.0);
  EXPECT_EQ(unit.time(), 0.0);
}

TEST(AxisUnit, GoesBackToASnapshot) {
  AxisUnit unit = mass();
  unit.set(reference_of("T_d"), 0.25);
  unit.set(kCommandVariable, 4.0);
  unit.step(0.0, 0.1);  // a command is still on its way
  const std::vector<char> then = unit.snapshot();
  const auto end = [&] {
    unit.step(0.1, 0.9);
    return unit.value(kVelocity);
  };
  const double first = end();
  EXPECT_GT(first, 0.0);
  unit.restore(then);
  EXPECT_EQ(unit.time(), 0.1);
  EXPECT_EQ(end(), first);
  AxisUnit other = mass();
  std::vector<char> cut = then;
  cut.pop_back();
  EXPECT_EQ(message_of([&] { other.restore(cut); }), "this is no state of the axis");
}

TEST(AxisUnit, RefusesWhatCannotBe) {
  AxisUnit unit = mass();
  EXPECT_EQ(message_of([&] { unit.value(99); }), "no variable has the value reference 99");
  EXPECT_EQ(message_of([&] { unit.set(kChannelVariables, 1.0); }),
            "no variable has the value reference 2");
  EXPECT_EQ(message_of([&] { unit.set(kCommandVariable, INFINITY); }),
            "the value for the value reference 1 is not finite");
  EXPECT_EQ(message_of([&] { unit.set(reference_of("M"), -1.0); }),
            "M must be from 0.001 to 100000 kg, not -1");
  EXPECT_EQ(message_of([&] { unit.step(0.0, -0.1); }), "a step of -0.1 s is not possible");
  EXPECT_EQ(message_of([&] { unit.step(0.2, 0.1); }),
            "a step from 0.2 s is not possible, since the axis is at 0 s");
  EXPECT_EQ(message_of([&] { unit.set_start(1.0); }), "");
  unit.step(1.0, 0.1);
  EXPECT_EQ(message_of([&] { unit.set_start(0.0); }),
            "the start cannot be set any more: the axis has moved");
  EXPECT_EQ(message_of([&] { unit.set(reference_of("initial.y0"), 0.1); }),
            "initial.y0 cannot be set any more: the axis has moved");
  EXPECT_EQ(message_of([&] { unit.set(reference_of("k_g"), 1e6); }).substr(0, 35),
            "no variable has the value reference")
      << "a rigid axis has none";
}

}  // namespace
}  // namespace axisfit
