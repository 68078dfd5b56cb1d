// Closing the loop on harder cases: the paper's axis with its gear, several effects, and what is in
// no catalogue.
#include <gtest/gtest.h>

#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

using Names = std::set<std::string>;

bool is_curve(const std::string& name) { return name.find("_over_") != std::string::npos; }

/// Expects that what was accepted are curves, at least one.
void expect_curves_only(const EffectSelection& selection) {
  EXPECT_FALSE(accepted(selection).empty());
  for (const std::string& name : accepted(selection)) EXPECT_TRUE(is_curve(name)) << name;
}

/// A bump of the force along the stroke, about 0.1 m wide.
void put_bump_into(Model<double>& model, double size) {
  auto& curve = add_effect<ForceOverPosition>(model);
  curve.c[7] = size;
  curve.c[8] = 0.7 * size;
  curve.from = -0.1;
  curve.to = 0.4;
}

TEST(SelectEffectsOnTheSlide, DrawsACurveOfAForceThatIsInNoCatalogue) {
  Model<double> truth = slide();
  put_bump_into(truth, 15.0);
  const EffectSelection selection = close(two_recordings(truth, slide(), {"M", "B_a"}));
  expect_curves_only(selection);
  expect_found(selection, "M", 20.0);
}

TEST(SelectEffectsOnTheSlide, AddsNoMoreThanIsAllowed) {
  Model<double> truth = slide();
  hidden_effect_named("coulomb_friction").put_into(truth);
  hidden_effect_named("added_mass").put_into(truth);
  const Job job = two_recordings(truth, slide(), {"B_a"});
  SearchOptions options;
  options.max_effects = 1;
  EXPECT_LE(accepted(select_effects(job, estimate(job), options)).size(), 1u);
}

TEST(SelectEffectsOnTheSlide, FindsThreeEffects) {
  Model<double> truth = slide();
  for (const char* name : {"coulomb_friction", "stroke_spring", "drive_lag"})
    hidden_effect_named(name).put_into(truth);
  const EffectSelection selection = close(two_recordings(truth, slide(), {"M", "B_a"}));
  EXPECT_EQ(accepted(selection), (Names{"coulomb_friction", "stroke_spring", "drive_lag"}));
  EXPECT_TRUE(selection.explained);
  expect_found(selection, "coulomb_friction.F_c", 5.0);
  expect_found(selection, "stroke_spring.k_s", 20.0);
  expect_found(selection, "drive_lag.T_l", 2e-3);
}

/// Velocity, acceleration and tachometer of the paper's axis.
Job paper_job(const Model<double>& truth, const std::vector<const char*>& free) {
  return two_recordings(truth, paper_axis(), free, 9.0,
                        {Signal::velocity, Signal::acceleration, Signal::tachometer});
}

std::vector<HiddenEffect> paper_secrets() {
  return {
      {"friction", "coulomb_friction", {{"coulomb_friction.F_c", 15.0}}},
      {"arm force", "constant_force", {{"constant_force.F_0", 10.0}}},
      {"inertia", "added_mass", {{"added_mass.dM", 5.0}}},
      {"drive", "drive_lag", {{"drive_lag.T_l", 2e-3}}},
      {"sensor", "acceleration.bias", {{"acceleration.bias", 0.05}}},
      {"sensor", "tachometer.gain", {{"tachometer.gain", 1.02}}},
  };
}

class OnThePapersAxis : public testing::TestWithParam<HiddenEffect> {};

TEST_P(OnThePapersAxis, OneUndeclaredEffectIsAcceptedAlone) {
  const HiddenEffect& secret = GetParam();
  Model<double> truth = paper_axis();
  secret.put_into(truth);
  const EffectSelection selection = close(paper_job(truth, {"B_a", "k_g", "T_p"}));
  EXPECT_EQ(accepted(selection), Names{secret.name});
  EXPECT_TRUE(selection.explained);
  for (const auto& [name, value] : secret.strengths) expect_found(selection, name, value);
  expect_found(selection, "B_a", 200.0);
  expect_found(selection, "k_g", 5e6);
  expect_found(selection, "T_p", 0.04);
}

INSTANTIATE_TEST_SUITE_P(EverySlot, OnThePapersAxis, testing::ValuesIn(paper_secrets()),
                         [](const auto& one) { return one.param.label(); });

TEST(SelectEffectsOnThePapersAxis, AddsNothingForNoiseThatIsLargerThanStated) {
  Job job = paper_job(paper_axis(), {"B_a", "k_g", "T_p"});
  for (Recording& r : job.recordings)
    for (Measurement& m : r.measurements) m.sigma *= 0.7;
  EXPECT_EQ(accepted(close(job)), Names{});
}

// The paper's own axis, by somebody who takes its gear for rigid.
TEST(SelectEffects, FindsTheBacklashOfThePaper) {
  Model<double> declared = paper_axis();
  declared.structure.transmission = Transmission::rigid;
  const EffectSelection selection = close(two_recordings(
      paper_axis(), declared, {"V_L", "B_a"}, 6.0, {Signal::velocity, Signal::acceleration}));
  EXPECT_EQ(accepted(selection), Names{"backlash"});
  EXPECT_TRUE(selection.explained);
  for (const char* name : {"H", "k_g", "b_g", "V_L", "B_a"}) {
    Model<double> truth = paper_axis();
    expect_found(selection, name, *members(truth)[quantity_index(name)]);
  }
}

}  // namespace
}  // namespace axisfit
