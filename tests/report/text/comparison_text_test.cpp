#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "report/text/report_text.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

/// The declared model and one with friction, which is preferred.
RunResult compared() {
  RunResult run_result;
  run_result.options.compare = true;
  Comparison& c = run_result.comparison.emplace();
  c.horizons = {0.5, 0.0};
  c.judged = 0.5;
  c.windows = 24;
  c.models.resize(2);
  ComparedModel &declared = c.models[0], &rubbing = c.models[1];
  declared.parameters = {estimated("M", 4.0, 0.1)};
  declared.missing_force = 12.345;
  declared.free_running = {0.2, 0.35};
  declared.inside_percent = 90.4;
  declared.aic = 140.0;
  declared.bic = 130.0;
  declared.log_ratio = std::log(1.5);
  declared.log_ratio_error = declared.log_ratio / 3.1;
  declared.windows_lost = 20;
  rubbing.name = "coulomb_friction";
  rubbing.parameters = {estimated("M", 4.25, 0.05), estimated("coulomb_friction.F_c", 6.125, 0.0)};
  rubbing.missing_force = 1.5;
  rubbing.free_running = {0.1, 0.12};
  rubbing.inside_percent = 95.0;
  rubbing.aic = 100.0;
  rubbing.bic = 94.0;
  c.preferred = 1;
  return run_result;
}

std::string told(const RunResult& run_result) {
  const std::string text = comparison_text(run_result);
  expect_narrow(text);
  return on_one_line(text);
}

TEST(ComparisonText, SetsModelsSideBySide) {
  const std::string text = told(compared());
  EXPECT_EQ(
      text,
      "Models compared on the recordings to validate free force 0.5 s whole band AIC BIC "
      "1 declared 1 12.3 20 35 90 % 40 36 2 + coulomb_friction 2 1.5 10 12 95 % 0 0 "
      "Free parameters; missing force, N rms; free-running error over windows of so many seconds "
      "and over all, in per cent of the standard deviation of the signals; how much the 95 % band "
      "holds; and, of what was fitted, AIC and BIC above the lowest. "
      "1 2 M 4.00 +- 0.1 4.250 +- 0.05 coulomb_friction.F_c 6.125 "
      "Preferred: + coulomb_friction. Over 0.5 s declared errs 1.50 times as much (3.1 standard "
      "errors), more in 20 of 24 windows.");
}

TEST(ComparisonText, SaysWhyASimplerModelIsPreferred) {
  RunResult run_result = compared();
  Comparison& c = *run_result.comparison;
  c.preferred = 0;
  c.models[0].log_ratio = 0.0;
  c.models[1].log_ratio = -0.1;
  c.models[1].log_ratio_error = 0.08;
  EXPECT_NE(told(run_result)
                .find("Preferred: declared. Over 0.5 s + coulomb_friction errs 0.90 times as much "
                      "(-1.2 standard errors), more in 0 of 24 windows. It is preferred for its 1 "
                      "parameters: no other errs less by more than two standard errors."),
            std::string::npos)
      << told(run_result);
}

// One that was fitted elsewhere is no step of the loop, and what cannot be had is left out.
TEST(ComparisonText, TakesModelsOfOtherFits) {
  RunResult run_result = compared();
  run_result.options.others.resize(1);
  run_result.options.others[0].name = "old.yaml";
  ComparedModel& other = run_result.comparison->models[1];
  other = {};
  other.name = "old.yaml";
  other.free_running = {0.4, ComparedModel::kNone};
  run_result.comparison->preferred = 0;
  run_result.comparison->models[0].log_ratio = 0.0;
  other.log_ratio = std::log(2.0);
  EXPECT_NE(told(run_result).find(" 2 old.yaml - - 40 - - - - Free parameters;"), std::string::npos)
      << told(run_result);
  EXPECT_NE(told(run_result).find("old.yaml errs 2.00 times as much (- standard errors)"),
            std::string::npos)
      << "without an error";
}

TEST(ComparisonText, OfAJointIsInItsWords) {
  RunResult run_result = compared();
  run_result.baseline.model.structure.joint = Joint::revolute;
  EXPECT_NE(told(run_result).find("missing torque, N m rms"), std::string::npos);
}

TEST(ComparisonText, SaysWhatIsMissing) {
  RunResult run_result = compared();
  run_result.comparison.reset();
  EXPECT_EQ(told(run_result),
            "Nothing to compare models on: give a recording the role 'validate' that they can be "
            "simulated through.");
  run_result.options.compare = false;
  EXPECT_EQ(comparison_text(run_result), "");
}

}  // namespace
}  // namespace axisfit
