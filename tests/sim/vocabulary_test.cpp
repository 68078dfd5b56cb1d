// Names, units and ranges on a revolute joint follow from those of a prismatic one.
#include "sim/vocabulary.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "base/units.h"
#include "sim/model.h"

namespace axisfit {
namespace {

TEST(RevoluteJoint, HasItsOwnWordsAndUnits) {
  EXPECT_EQ(unit_on(Joint::revolute, "N s/m"), "N m s/rad");
  EXPECT_EQ(unit_on(Joint::revolute, "ohm"), "ohm");
  EXPECT_EQ(words_on(Joint::revolute, "constant_force"), "constant_torque");
  EXPECT_EQ(words_on(Joint::revolute, "Missing force on the arm"), "Missing torque on the joint");
  EXPECT_EQ(words_on(Joint::revolute, "armature inertia"), "armature inertia");
  EXPECT_EQ(words_on(Joint::prismatic, "Missing force on the arm"), "Missing force on the arm");
}

TEST(RevoluteJoint, NamesQuantitiesByTheirKind) {
  const auto called = [](const char* name) -> const QuantityEntry& {
    return quantity_list(Joint::revolute)[quantity_index(name)];
  };
  EXPECT_EQ(called("M").name, "J");
  EXPECT_EQ(called("M").quantity.unit, "kg m^2");
  EXPECT_EQ(called("M").quantity.meaning, "joint inertia");
  EXPECT_EQ(called("F_s").name, "T_s");
  EXPECT_EQ(called("stribeck_friction.F_st").name, "stribeck_friction.T_st");
  EXPECT_EQ(called("directional_friction.dF_c").name, "directional_friction.dT_c");
  EXPECT_EQ(called("added_mass.dM").name, "added_inertia.dJ");
  EXPECT_EQ(called("force_over_velocity.to").quantity.unit, "rad/s");
  EXPECT_EQ(called("drive_force.bias").name, "drive_torque.bias");
  EXPECT_EQ(called("r_g").quantity.unit, "1");
  EXPECT_EQ(called("J_m").quantity.unit, "kg m^2");
  EXPECT_EQ(called("J_m").name, "J_m");
}

// The same place in both lists is the same quantity.
TEST(RevoluteJoint, ListsTheSameQuantities) {
  const auto &sliding = quantity_list(), &turning = quantity_list(Joint::revolute);
  ASSERT_EQ(sliding.size(), turning.size());
  std::set<std::string> names;
  for (std::size_t i = 0; i < sliding.size(); ++i) {
    EXPECT_TRUE(names.insert(turning[i].name).second) << turning[i].name << " stands for two";
    EXPECT_EQ(find_quantity(turning[i].name, Joint::revolute), &turning[i]);
    EXPECT_EQ(turning[i].effect, sliding[i].effect);
    EXPECT_EQ(turning[i].signal, sliding[i].signal);
    EXPECT_EQ(turning[i].quantity.shape, sliding[i].quantity.shape);
    EXPECT_LE(turning[i].quantity.lower, sliding[i].quantity.lower) << turning[i].name;
    EXPECT_GE(turning[i].quantity.upper, sliding[i].quantity.upper) << turning[i].name;
  }
}

// A unit or word that has been forgotten would show here.
TEST(RevoluteJoint, LeavesNoUnitOrWordOfALoadThatSlides) {
  const std::regex length(R"((^|[^N] )m\b|/m\b|\bkg(?! m\^2)|\bN(?! m))");
  const std::regex word(R"(\b(force|forces|mass|arm|stroke|newtons|metres|rack|pinion radius)\b)");
  for (const QuantityEntry& entry : quantity_list(Joint::revolute)) {
    const std::string unit(entry.quantity.unit), meaning(entry.quantity.meaning);
    const bool is_motor_side = unit == "kg m^2" || unit == "rad/(N m)" || unit == "1/(N m)";
    EXPECT_TRUE(is_motor_side || !std::regex_search(unit, length)) << entry.name << ": " << unit;
    EXPECT_FALSE(std::regex_search(meaning, word)) << entry.name << ": " << meaning;
    EXPECT_NO_THROW(is_dimensionless(unit)) << entry.name << ": " << unit;
  }
  for (const EffectInfo& effect : kEffectTable)
    for (const std::string_view text : {effect.name, effect.meaning, effect.excitation})
      EXPECT_FALSE(std::regex_search(std::string(words_on(Joint::revolute, text)),
                                     std::regex(R"((\b|_)(force|forces|mass|arm|stroke)(\b|_))")))
          << text;
}

}  // namespace
}  // namespace axisfit
