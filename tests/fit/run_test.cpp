#include "fit/run.h"

#include <gtest/gtest.h>

#include "tests/fit/selection/selection.h"

namespace axisfit {
namespace {

TEST(Run, TellsOfEveryModelWhatRestsOnGuesses) {
  Model<double> truth = slide();
  truth.structure.effects.set(*effect_named("coulomb_friction"));
  *members(truth)[find_quantity("coulomb_friction.F_c")->index] = 5.0;
  Job job = two_recordings(truth, slide(), {"M", "B_a"});
  job.guessed = {find_quantity("K_f")->index};
  const RunResult result = run(job, {.select_effects = true});
  ASSERT_TRUE(result.selection);
  ASSERT_EQ(result.selection->models.size(), 2u);
  const auto expect_known = [](const FitResult& fit) {
    for (const ParameterResult& p : fit.parameters) {
      ASSERT_EQ(p.rests_on.size(), 1u) << p.name;
      EXPECT_EQ(p.rests_on[0].name, "K_f");
      EXPECT_NEAR(p.rests_on[0].elasticity, 1.0, 1e-6);
    }
  };
  expect_known(result.first);
  expect_known(result.fit());
  for (const SelectionStep& model : result.selection->models) expect_known(model.fit);
}

TEST(Run, TellsNothingOfTheParametersOfAWrongModel) {
  // A stiff spring that nobody declared.
  HiddenEffect spring = hidden_effect_named("stroke_spring");
  spring.strengths[0].second = 1000.0;
  Job job = two_recordings(spring.truth(), slide(), {"M", "B_a"});
  job.guessed = {find_quantity("K_f")->index};
  const RunResult result = run(job);
  ASSERT_EQ(result.grade.grade, Grade::model_wrong);
  for (const ParameterResult& p : result.first.parameters) EXPECT_TRUE(p.rests_on.empty());
}

}  // namespace
}  // namespace axisfit
