#include "exports/fmu/axis_text.h"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>
#include <string>

#include "tests/exports/axes.h"

namespace axisfit {
namespace {

Model<double> model_of(const std::string& text) {
  std::istringstream in(text);
  return read_axis_text(in);
}

TEST(AxisText, ComesBackToTheDigit) {
  for (const auto& [name, rig] : axes()) {
    SCOPED_TRACE(name);
    Model<double> before = rig.model, after = model_of(axis_text(rig.model));
    EXPECT_EQ(after.structure.drive, before.structure.drive);
    EXPECT_EQ(after.structure.joint, before.structure.joint);
    EXPECT_EQ(after.structure.transmission, before.structure.transmission);
    EXPECT_EQ(after.structure.effects, before.structure.effects);
    for (const QuantityEntry& entry : quantity_list()) {
      if (entry.group == "controller" || !is_used(entry, before.structure)) continue;
      EXPECT_EQ(*members(after)[entry.index], *members(before)[entry.index]) << entry.name;
    }
    EXPECT_EQ(axis_text(after), axis_text(before));
  }
}

TEST(AxisText, ChannelsMayHaveUnitsOfSeveralWords) {
  Model<double> model = driven_mass(2.0);
  model.structure.channels = kept({{"oil", "degC", 20.5}, {"torque", "N m", 0.0}});
  const Model<double> after = model_of(axis_text(model));
  ASSERT_NE(after.structure.channels, nullptr);
  EXPECT_EQ(*after.structure.channels, *model.structure.channels);
}

TEST(AxisText, RefusesAnythingElse) {
  const std::string text = axis_text(driven_mass(2.0));
  EXPECT_NO_THROW(model_of(text));
  EXPECT_THROW(model_of(""), std::runtime_error);
  EXPECT_THROW(model_of("axisfit axis 2\n"), std::runtime_error);
  for (const char* line :
       {"drive 6", "drive -1", "drive x", "joint 2", "effect telepathy", "quantity M 2 kg",
        "quantity Mass 2", "channel 20", "quantity M", "M 2"}) {
    try {
      model_of(text + line + "\n");
      ADD_FAILURE() << line;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()),
                "the axis of the FMU cannot be read: \"" + std::string(line) + "\"");
    }
  }
}

}  // namespace
}  // namespace axisfit
