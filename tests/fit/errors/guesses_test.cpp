#include "fit/errors/guesses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

std::vector<std::vector<GuessInfluence>> guesses_beneath(const Job& job, const FitResult& fit) {
  return guess_influences(job, fit.parameters, fit.observer_gain);
}

// A motion shows only ratios to the gain of a force.
TEST(Guesses, AMassIsKnownOnlyAsARatioToAGuessedGain) {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  job.guessed = {quantity_index("K_f"), quantity_index("F_s")};  // there is no part of zero
  const FitResult fit = estimate(job);
  const auto influences = guesses_beneath(job, fit);
  ASSERT_EQ(influences.size(), 2u);
  for (const auto& of_parameter : influences) {
    ASSERT_EQ(of_parameter.size(), 1u);
    EXPECT_EQ(of_parameter[0].id, id_of("K_f"));
    EXPECT_NEAR(of_parameter[0].elasticity, 1.0, 1e-6);
  }
}

// The derivative is that of the estimates: a refit with another guess finds the same.
TEST(Guesses, ChangeTheEstimatesAsARefitDoes) {
  Job job = two_recordings(motor_axis(), motor_axis(), {"T_p", "B_a"});
  job.guessed = {quantity_index("K_t")};
  const FitResult fit = estimate(job);
  const auto influences = guesses_beneath(job, fit);
  constexpr double kChange = 1.001;
  job.model.axis.K_t *= kChange;
  const FitResult refitted = estimate(job);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(influences[i].size(), 1u) << name_of(fit.parameters[i].id);
    const double found =
        std::log(refitted.parameters[i].value / fit.parameters[i].value) / std::log(kChange);
    EXPECT_NEAR(influences[i][0].elasticity, found, 0.02 * std::abs(found));
  }
}

TEST(Guesses, AreOfNoAccountWhereNothingRestsOnThem) {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  job.model.axis.F_s = 1e-6;
  job.guessed = {quantity_index("F_s")};
  const FitResult fit = estimate(job);
  for (const auto& of_parameter : guesses_beneath(job, fit)) EXPECT_TRUE(of_parameter.empty());
  // What is estimated is no guess.
  job.guessed = {quantity_index("M")};
  for (const auto& of_parameter : guesses_beneath(job, fit)) EXPECT_TRUE(of_parameter.empty());
}

TEST(Guesses, OnesThatAreNegativeCountByTheirSize) {
  Model<double> truth = slide();
  truth.structure.effects.set(*effect_named("constant_force"));
  truth.structure.effects.set(*effect_named("coulomb_friction"));
  *members(truth)[quantity_index("constant_force.F_0")] = -20.0;
  *members(truth)[quantity_index("coulomb_friction.F_c")] = 5.0;
  Job job = two_recordings(truth, truth, {"M", "B_a", "coulomb_friction.F_c"});
  job.guessed = {quantity_index("constant_force.F_0")};
  const auto influences = guesses_beneath(job, estimate(job));
  *members(job.model)[quantity_index("constant_force.F_0")] *= 1.001;
  const double mass = estimate(job).parameters[0].value;
  *members(job.model)[quantity_index("constant_force.F_0")] /= 1.001;
  const double found = std::log(mass / estimate(job).parameters[0].value) / std::log(1.001);
  ASSERT_EQ(influences[0].size(), 1u) << found;
  EXPECT_NEAR(influences[0][0].elasticity, found, 0.02 * std::abs(found));
}

}  // namespace
}  // namespace axisfit
