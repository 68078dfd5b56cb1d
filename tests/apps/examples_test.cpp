// The worked examples of docs/examples.md and docs/tutorial.md find the truth of their recordings,
// as testdata/README.md states it. EMPS, a measured axis, has a test of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "fit/run.h"
#include "io/config/job_file.h"
#include "report/text/names.h"

namespace axisfit {
namespace {

using Truth = std::map<std::string, double>;

RunResult run_result_of(const std::string& job, const RunOptions& run_options = {}) {
  return run(read_job_file(AXISFIT_CONFIGS "/jobs/" + job).job, run_options);
}

/// Every parameter lies within three standard errors of the truth, and nothing but noise is left in
/// any recording, fitted or not.
void expect_truth(const RunResult& run_result, const Truth& truth) {
  const FitResult& fit = run_result.fit();
  ASSERT_TRUE(fit.is_usable()) << fit.message;
  EXPECT_NEAR(fit.reduced_chi_square, 1.0, 0.05);
  EXPECT_TRUE(run_result.diagnosis->explained);
  ASSERT_EQ(fit.parameters.size(), truth.size());
  for (const ParameterResult& p : fit.parameters) {
    const std::string name = name_of(run_result.job(), p.id);
    ASSERT_TRUE(truth.contains(name)) << name;
    EXPECT_TRUE(p.uncertainty.determined) << name;
    EXPECT_NEAR(p.value, truth.at(name), 3.0 * p.uncertainty.standard_error) << name;
  }
}

Truth truth_of_the_paper() {
  return {{"V_L", 2.7}, {"B_a", 200.0}, {"b_g", 1500.0}, {"k_g", 5e6}, {"T_p", 0.04}};
}

/// What turns is seen at the table, r_g^2 being the ratio.
Truth truth_of_the_screw() {
  const double r_g = 10e-3 / (2.0 * std::numbers::pi);
  return {{"M", 62.0 + 6e-5 / (r_g * r_g)},
          {"B_a", 180.0 + 2e-4 / (r_g * r_g)},
          {"coulomb_friction.F_c", 35.0},
          {"constant_force.F_0", -6.0}};
}

TEST(ExamplesTest, PaperStep) { expect_truth(run_result_of("paper.yaml"), truth_of_the_paper()); }

TEST(ExamplesTest, PaperMove) {
  expect_truth(run_result_of("paper-move.yaml"), truth_of_the_paper());
}

TEST(ExamplesTest, Screw) { expect_truth(run_result_of("screw.yaml"), truth_of_the_screw()); }

TEST(ExamplesTest, ScrewWithoutDryFrictionIsGivenIt) {
  const RunResult run_result = run_result_of("screw-viscous.yaml", {.select_effects = true});
  EXPECT_GT(run_result.first.reduced_chi_square, 100.0);
  ASSERT_TRUE(run_result.selection);
  EXPECT_EQ(run_result.selection->models.size(), 2u);
  expect_truth(run_result, truth_of_the_screw());
}

// docs/tutorial.md
TEST(ExamplesTest, BentScrewIsGivenAForceOncePerTurn) {
  const RunResult run_result = run_result_of("screw-bent.yaml", {.select_effects = true});
  EXPECT_GT(run_result.first.reduced_chi_square, 10.0);
  ASSERT_TRUE(run_result.selection);
  EXPECT_EQ(run_result.selection->models.size(), 2u);
  Truth truth = truth_of_the_screw();
  truth.insert({{"periodic_force.F_s1", 6.0},
                {"periodic_force.F_c1", 0.0},
                {"periodic_force.period", 0.01}});
  expect_truth(run_result, truth);
}

// By a simulation of bench/channels.py: three of four channels do nothing.
TEST(ExamplesTest, ARecordedTemperatureIsNamed) {
  const RunResult result = run_result_of("channels.yaml", {.select_effects = true});
  EXPECT_GT(result.first.reduced_chi_square, 5.0);
  ASSERT_TRUE(result.selection);
  EXPECT_EQ(result.selection->models.size(), 2u);
  EXPECT_TRUE(result.diagnosis->explained);
  std::map<std::string, double> found;
  for (const ParameterResult& p : result.fit().parameters)
    found[name_of(result.job(), p.id)] = p.value;
  ASSERT_TRUE(found.contains("channel_friction.temperature"));
  // The law is an exponential, and there is a little drag besides: its tangent, within model error.
  EXPECT_NEAR(found["channel_friction.temperature"], -0.0793, 0.003);
  EXPECT_NEAR(found["M"], 15.544, 0.06);
}

TEST(ExamplesTest, TwoPayloads) {
  const RunResult run_result = run_result_of("payload.yaml");
  expect_truth(run_result, {{"M@empty", 146.0},
                            {"M@loaded", 161.0},
                            {"V_L", 2.7},
                            {"B_a", 200.0},
                            {"b_g", 1500.0},
                            {"k_g", 5e6}});

  // The masses err together, so that their difference is known much better than each of them.
  const FitResult& fit = run_result.fit();
  const double empty = fit.parameters[0].uncertainty.standard_error;
  const double loaded = fit.parameters[1].uncertainty.standard_error;
  const double error =
      std::sqrt(empty * empty + loaded * loaded - 2.0 * fit.correlation(0, 1) * empty * loaded);
  EXPECT_LT(error, 0.15 * loaded);
  EXPECT_NEAR(fit.parameters[1].value - fit.parameters[0].value, 15.0, 3.0 * error);
}

// The drive follows what it has delayed and smoothed. The generator's loop is not quite that of the
// axis file, so that more than noise is left.
TEST(ExamplesTest, AReferenceThatTheDriveDelaysAndSmooths) {
  const RunResult result =
      run(read_job_file(AXISFIT_TESTDATA "/contact/delayed-reference.yaml").job);
  const FitResult& fit = result.fit();
  ASSERT_TRUE(result.grade.is_usable());
  EXPECT_LT(fit.reduced_chi_square, 300.0);
  const auto value = [&](const char* name) {
    return std::ranges::find(fit.parameters, ParameterId{quantity_index(name)},
                             &ParameterResult::id)
        ->value;
  };
  EXPECT_NEAR(value("M"), 40.0, 0.4);
  EXPECT_NEAR(value("B_a"), 120.0, 5.0);
  EXPECT_NEAR(value("coulomb_friction.F_c"), 15.0, 2.0);
}

}  // namespace
}  // namespace axisfit
