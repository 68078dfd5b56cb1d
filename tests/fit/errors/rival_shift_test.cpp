#include "fit/errors/rival_shift.h"

#include <gtest/gtest.h>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

ParameterResult estimate_of(const char* name, double value, double error) {
  ParameterResult p{name, value, {}};
  p.uncertainty.determined = true;
  p.uncertainty.standard_error = error;
  p.uncertainty.lower = value - 2.0 * error;
  p.uncertainty.upper = value + 2.0 * error;
  return p;
}

/// A result with a mass that is undecided against two gains, and two parameters of the machine, of
/// which one differs with the gains.
EffectSelection undecided_mass() {
  EffectSelection selection;
  selection.result.job.model = slide();
  for (const char* name : {"B_a", "M", "added_mass.dM"}) {
    FreeParameter free = free_parameter(name, 1.0);
    free.logarithmic = false;
    free.lower = -1e3;
    free.upper = 1e3;
    selection.result.job.free.push_back(free);
  }
  selection.result.fit.parameters = {estimate_of("B_a", 10.0, 0.3), estimate_of("M", 5.0, 0.3),
                                     estimate_of("added_mass.dM", 1.0, 0.1)};
  EffectTrial trial;
  trial.candidate.name = "added_mass";
  trial.parameters = {selection.result.fit.parameters.back()};
  selection.effects = {trial};
  const auto with = [](double friction, double mass, double added) {
    Model<double> model = slide();
    *members(model)[find_quantity("B_a")->index] = friction;
    *members(model)[find_quantity("M")->index] = mass;
    *members(model)[find_quantity("added_mass.dM")->index] = added;
    return model;
  };
  selection.rivals = {{"added_mass", "velocity.gain", with(10.1, 5.0, 1.0), with(10.5, 5.2, 0.0)},
                      {"added_mass", "position.gain", with(10.1, 5.0, 1.0), with(9.6, 5.2, 0.0)}};
  return selection;
}

TEST(AllowForRivals, CountsTheLargestMoveAsAFurtherError) {
  EffectSelection selection = undecided_mass();
  allow_for_rivals(selection);
  const ParameterResult& friction = selection.result.fit.parameters[0];
  ASSERT_TRUE(friction.rival_shift);
  EXPECT_EQ(friction.rival_shift->chosen, "added_mass");
  EXPECT_EQ(friction.rival_shift->rival, "position.gain");
  EXPECT_DOUBLE_EQ(friction.rival_shift->value, 9.5);
  EXPECT_DOUBLE_EQ(friction.uncertainty.standard_error, std::hypot(0.3, 0.5));
  EXPECT_DOUBLE_EQ(friction.uncertainty.lower, 10.0 - 2.0 * std::hypot(0.3, 0.5));
}

TEST(AllowForRivals, LeavesWhatHardlyMovesAndTheEffectItself) {
  EffectSelection selection = undecided_mass();
  allow_for_rivals(selection);
  for (const std::size_t i : {1u, 2u}) {
    const ParameterResult& p = selection.result.fit.parameters[i];
    EXPECT_FALSE(p.rival_shift) << p.name;
    EXPECT_EQ(p.uncertainty.standard_error, i == 1 ? 0.3 : 0.1);
  }
}

}  // namespace
}  // namespace axisfit
