// Closing the loop on harder cases: the paper's axis with its gear, several effects, and what is in
// no catalogue.
#include <gtest/gtest.h>

#include "tests/fit/selection/selection.h"

namespace axisfit {
namespace {

using Names = std::set<std::string>;

bool is_curve(const std::string& name) { return name.starts_with("force_over_"); }

/// Expects that what was accepted are curves, at least one.
void expect_curves_only(const ClosedLoop& loop) {
  EXPECT_FALSE(accepted(loop).empty()) << loop.verdict;
  for (const std::string& name : accepted(loop)) EXPECT_TRUE(is_curve(name)) << name;
}

/// A bump of the force along the stroke, about 0.1 m wide.
void put_bump_into(Model<double>& model, double size) {
  auto& curve = add_effect<ForceOverPosition>(model);
  curve.c[7] = size;
  curve.c[8] = 0.7 * size;
  curve.from = -0.1;
  curve.to = 0.4;
}

TEST(CloseLoopOnTheSlide, DrawsACurveOfAForceThatIsInNoCatalogue) {
  Model<double> truth = slide();
  put_bump_into(truth, 15.0);
  const ClosedLoop loop = close(two_recordings(truth, slide(), {"M", "B_a"}));
  expect_curves_only(loop);
  expect_found(loop, "M", 20.0);
}

TEST(CloseLoopOnTheSlide, AddsNoMoreThanIsAllowed) {
  Model<double> truth = slide();
  secret_named("coulomb_friction").put_into(truth);
  secret_named("added_mass").put_into(truth);
  const Job job = two_recordings(truth, slide(), {"B_a"});
  CloseLoopOptions options;
  options.max_effects = 1;
  EXPECT_LE(accepted(close_loop(job, estimate(job), options)).size(), 1u);
}

TEST(CloseLoopOnTheSlide, FindsThreeEffects) {
  Model<double> truth = slide();
  for (const char* name : {"coulomb_friction", "stroke_spring", "drive_lag"})
    secret_named(name).put_into(truth);
  const ClosedLoop loop = close(two_recordings(truth, slide(), {"M", "B_a"}));
  EXPECT_EQ(accepted(loop), (Names{"coulomb_friction", "stroke_spring", "drive_lag"}));
  EXPECT_TRUE(loop.explained);
  expect_found(loop, "coulomb_friction.F_c", 5.0);
  expect_found(loop, "stroke_spring.k_s", 20.0);
  expect_found(loop, "drive_lag.T_l", 2e-3);
}

/// Velocity, acceleration and tachometer of the paper's axis.
Job paper_job(const Model<double>& truth, const std::vector<const char*>& free) {
  return two_recordings(truth, paper_axis(), free, 9.0,
                        {Signal::velocity, Signal::acceleration, Signal::tachometer});
}

std::vector<Secret> paper_secrets() {
  return {
      {"friction", "coulomb_friction", {{"coulomb_friction.F_c", 15.0}}},
      {"arm force", "constant_force", {{"constant_force.F_0", 10.0}}},
      {"inertia", "added_mass", {{"added_mass.dM", 5.0}}},
      {"drive", "drive_lag", {{"drive_lag.T_l", 2e-3}}},
      {"sensor", "acceleration.bias", {{"acceleration.bias", 0.05}}},
      {"sensor", "tachometer.gain", {{"tachometer.gain", 1.02}}},
  };
}

class OnThePapersAxis : public testing::TestWithParam<Secret> {};

TEST_P(OnThePapersAxis, OneUndeclaredEffectIsAcceptedAlone) {
  const Secret& secret = GetParam();
  Model<double> truth = paper_axis();
  secret.put_into(truth);
  const ClosedLoop loop = close(paper_job(truth, {"B_a", "k_g", "T_p"}));
  EXPECT_EQ(accepted(loop), Names{secret.name}) << loop.verdict;
  EXPECT_TRUE(loop.explained);
  for (const auto& [name, value] : secret.strengths) expect_found(loop, name, value);
  expect_found(loop, "B_a", 200.0);
  expect_found(loop, "k_g", 5e6);
  expect_found(loop, "T_p", 0.04);
}

INSTANTIATE_TEST_SUITE_P(EverySlot, OnThePapersAxis, testing::ValuesIn(paper_secrets()),
                         [](const auto& one) { return one.param.label(); });

TEST(CloseLoopOnThePapersAxis, AddsNothingForNoiseThatIsLargerThanStated) {
  Job job = paper_job(paper_axis(), {"B_a", "k_g", "T_p"});
  for (Recording& r : job.recordings)
    for (Measurement& m : r.measurements) m.sigma *= 0.7;
  EXPECT_EQ(accepted(close(job)), Names{});
}

}  // namespace
}  // namespace axisfit
