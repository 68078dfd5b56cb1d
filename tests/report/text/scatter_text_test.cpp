#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "report/text/report_text.h"
#include "tests/fit/scattering.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

TEST(ScatterTextTest, NamesTheRecordingWithTheStretches) {
  Job job = scattering_machine(2, 0.0, 6, 6.0);
  job.recordings[0].role = Role::validate;
  const std::string text = scatter_text(run(job));
  EXPECT_NE(text.find("Scatter between 6 stretches of run-2\n"), std::string::npos) << text;
}

/// The scatter between two recordings, by hand.
RunResult scattered() {
  RunResult run_result;
  run_result.baseline = scattering_machine(2, 0.0, 1, 0.1);
  run_result.first.parameters = {
      {{quantity_index("M")}, 12.0, {.determined = true, .standard_error = 0.5}},
      {{quantity_index("B_a")}, 40.0, {.determined = true, .standard_error = 2.0}}};
  Scatter& scatter = run_result.scatter.emplace();
  scatter.groups = {{0, true, 0.0, 0.1}, {1, true, 0.0, 0.1}};
  ParameterScatter mass, damping;
  mass.within = 0.5;
  mass.upper = 0.75;
  mass.groups = {{11.8, 0.3, true}, {12.9, 0.3, true}};
  damping.parameter = 1;
  damping.within = 0.25;
  damping.deviation = 1.5;
  damping.lower = 0.5;
  damping.upper = 30.0;
  damping.groups = {{38.0, 0.3, true}, {42.0, 0.4, true}};
  scatter.parameters = {mass, damping};
  return run_result;
}

TEST(ScatterTextTest, TellsOfEveryParameterAndOfAStep) {
  EXPECT_EQ(on_one_line(scatter_text(scattered())),
            "Scatter between 2 recordings error within scatter 95 % interval for the machine unit "
            "M 0.5 none seen 0 .. 0.75 0.5 kg B_a 0.25 1.5 0.5 .. 30 2 N s/m Standard errors and "
            "intervals above are for the machine: those of B_a include the scatter. Two say little "
            "of a scatter: its interval tells how little. B_a steps from 38.00 (run-1) to 42.00 N "
            "s/m (run-2): 8 standard errors.");
}

TEST(ScatterTextTest, WhatTheScatterLeavesOpenHasNoErrorForTheMachine) {
  RunResult run_result = scattered();
  run_result.first.parameters[1].uncertainty = {};
  const std::string text = on_one_line(scatter_text(run_result));
  EXPECT_NE(text.find("B_a 0.25 1.5 0.5 .. 30 - N s/m"), std::string::npos) << text;
  EXPECT_EQ(text.find("include the scatter"), std::string::npos) << text;
}

TEST(ScatterTextTest, NoStepIsWithinFourStandardErrorsOrOfWhatIsOpen) {
  RunResult run_result = scattered();
  std::vector<EstimateOfGroup>& groups = run_result.scatter->parameters[1].groups;
  groups[1].value = 39.9;  // 3.8 standard errors
  EXPECT_EQ(scatter_text(run_result).find("steps from"), std::string::npos);
  groups[1].value = 42.0;
  groups[1].determined = false;
  EXPECT_EQ(scatter_text(run_result).find("steps from"), std::string::npos);
}

TEST(ScatterTextTest, OfMoreThanTwoSaysNothingOfTheirNumber) {
  RunResult run_result = scattered();
  run_result.scatter->groups.push_back({1, true, 0.0, 0.1});
  run_result.scatter->parameters[1].deviation = 0.0;
  const std::string text = scatter_text(run_result);
  EXPECT_EQ(text.find("Two say little"), std::string::npos);
  EXPECT_EQ(text.find("include the scatter"), std::string::npos);
  run_result.scatter.reset();
  EXPECT_EQ(scatter_text(run_result), "");
}

}  // namespace
}  // namespace axisfit
