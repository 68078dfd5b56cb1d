#include "fit/search/rival_models.h"

#include <gtest/gtest.h>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

TEST(RivalModels, HaveTheParametersOfTheChosenEffect) {
  EffectSelection selection;
  for (const auto& [name, parameter] :
       {std::pair("velocity.gain", "velocity.gain"), std::pair("added_mass", "added_mass.dM")}) {
    Outcome& outcome = selection.effects.emplace_back();
    outcome.hypothesis.name = name;
    outcome.parameters.push_back({id_of(parameter), 1.0, {}});
  }
  Model<double> heavier = slide();
  heavier.axis.M *= 2.0;
  selection.substitutions = {{"added_mass", "velocity.gain", heavier, slide()},
                             {"dead_time", "velocity.gain", slide(), heavier}};
  const std::vector<RivalModels> models = rival_models(selection);
  ASSERT_EQ(models.size(), 2u);
  EXPECT_EQ(models[0].chosen, "added_mass");
  EXPECT_EQ(models[0].rival, "velocity.gain");
  EXPECT_EQ(models[0].with_chosen.axis.M, heavier.axis.M);
  EXPECT_EQ(models[0].with_rival.axis.M, slide().axis.M);
  EXPECT_EQ(models[0].own, std::vector{id_of("added_mass.dM")});
  EXPECT_TRUE(models[1].own.empty());  // it had no trial
}

// It goes with the effect: what it is without that is no estimate.
TEST(RivalModels, HaveThePartsAndFormsOfTheChosenEffect) {
  EffectSelection selection;
  for (const auto& [name, parameter, extends] :
       {std::tuple("dahl_friction", "dahl_friction.F_d", ""),
        std::tuple("dahl_friction.B_d", "dahl_friction.B_d", "dahl_friction"),
        std::tuple("dahl_friction", "dahl_friction.l_d", ""),
        std::tuple("added_mass", "added_mass.dM", "")}) {
    Outcome& outcome = selection.effects.emplace_back();
    outcome.hypothesis.name = name;
    outcome.hypothesis.extends = extends;
    outcome.parameters.push_back({id_of(parameter), 1.0, {}});
  }
  selection.substitutions = {{"dahl_friction", "added_mass", slide(), slide()}};
  EXPECT_EQ(rival_models(selection).at(0).own,
            (std::vector{id_of("dahl_friction.F_d"), id_of("dahl_friction.B_d"),
                         id_of("dahl_friction.l_d")}));
}

}  // namespace
}  // namespace axisfit
