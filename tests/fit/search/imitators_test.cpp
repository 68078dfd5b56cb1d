#include "fit/search/imitators.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "fit/search/catalogue.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

/// A motor axis whose speed controller has 2 % more gain than its data sheet says.
Job wrong_feedback_gain() {
  Model<double> truth = motor_axis();
  truth.axis.K_2 *= 1.02;
  return two_recordings(truth, motor_axis(), {"B_a", "F_s"});
}

const Hypothesis& constant(const std::vector<Hypothesis>& list, const char* name) {
  return *std::ranges::find(list, name, &Hypothesis::name);
}

TEST(Imitators, OfAGainIsTheOtherInSeriesWithIt) {
  const Job declared = wrong_feedback_gain();
  const std::vector<Hypothesis> hypotheses = catalogue(declared, {});
  const Hypothesis& gain = constant(hypotheses, "K_2");
  ASSERT_TRUE(gain.kind == HypothesisKind::constant);
  std::vector<double> values;
  for (const FreeParameter& p : declared.free) values.push_back(p.initial);
  const Job job = with_hypothesis(declared, gain, values, {gain.neutral, {}});
  const FitResult fit = estimate(job);
  const std::vector<Scored> found = imitators(job, fit, gain, catalogue(job, {}));
  ASSERT_FALSE(found.empty());
  EXPECT_LE(found.size(), 4u);
  EXPECT_EQ(found.front().hypothesis->name, "K_t");
  EXPECT_NEAR(found.front().own.strengths[0] / motor_axis().axis.K_t, 1.02, 0.001);
  ASSERT_EQ(found.front().others.size(), declared.free.size());
  // What the other free parameters are does not depend on which of the two is to blame.
  EXPECT_NEAR(found.front().others[0], fit.parameters[0].value, 1e-3 * fit.parameters[0].value);
  for (const Scored& a : found) EXPECT_NE(a.hypothesis->name, "K_2");
}

TEST(Imitators, MakeACorrectionUndecided) {
  const EffectSelection selection = close(wrong_feedback_gain());
  const auto names = undecided(selection);
  EXPECT_TRUE(names.contains("K_2"));
  EXPECT_TRUE(names.contains("K_t"));
  EXPECT_TRUE(accepted(selection).empty());
}

// A gain of the drive would do if nothing but viscous friction and the mass opposed it.
TEST(Imitators, AreNoneWhereNothingImitatesIt) {
  Model<double> believed = slide();
  hidden_effect_named("coulomb_friction").put_into(believed);
  Model<double> truth = believed;
  truth.axis.B_a *= 1.5;
  const Job declared = two_recordings(truth, believed, {"M"});
  const EffectSelection selection = close(declared);
  EXPECT_EQ(accepted(selection), std::set<std::string>{"B_a"});
  EXPECT_TRUE(selection.explained);
}

}  // namespace
}  // namespace axisfit
