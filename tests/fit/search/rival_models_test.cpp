#include "fit/search/rival_models.h"

#include <gtest/gtest.h>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

TEST(RivalModels, HaveTheParametersOfTheChosenEffect) {
  EffectSelection selection;
  for (const char* name : {"velocity.gain", "added_mass"}) {
    EffectTrial& trial = selection.effects.emplace_back();
    trial.candidate.name = name;
    trial.parameters = {{std::string(name) + ".strength", 1.0, {}}};
  }
  Model<double> heavier = slide();
  heavier.axis.M *= 2.0;
  selection.rivals = {{"added_mass", "velocity.gain", heavier, slide()},
                      {"dead_time", "velocity.gain", slide(), heavier}};
  const std::vector<RivalModels> models = rival_models(selection);
  ASSERT_EQ(models.size(), 2u);
  EXPECT_EQ(models[0].chosen, "added_mass");
  EXPECT_EQ(models[0].rival, "velocity.gain");
  EXPECT_EQ(models[0].with_chosen.axis.M, heavier.axis.M);
  EXPECT_EQ(models[0].with_rival.axis.M, slide().axis.M);
  EXPECT_EQ(models[0].own, std::vector<std::string>{"added_mass.strength"});
  EXPECT_TRUE(models[1].own.empty());  // it had no trial
}

}  // namespace
}  // namespace axisfit
