#include "fleet/night_result.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/fit/scattering.h"

namespace axisfit {
namespace {

NightResult night() {
  NightResult night;
  night.axis = "x";
  night.night = "2026-09-01";
  night.status = "usable";
  night.reason = "none";
  night.fingerprint = "abc";
  night.seconds = 1.5;
  night.parameters = {{"B_a", "N s/m", 0.1, 1.0 / 3.0}, {"M", "kg", 12.0, NAN}};
  night.residuals = {{"run", "velocity", "m/s", "fit", 2e-3, INFINITY}};
  night.effects = {"periodic_force, period 0.036 m"};
  night.channels = {{"oil", 21.5}};
  return night;
}

TEST(NightResult, ComesBackFromJson) {
  const NightResult before = night();
  const std::string text = to_json(before).dump();
  const NightResult after = night_result_from(nlohmann::ordered_json::parse(text));
  EXPECT_EQ(to_json(after).dump(), text);
  EXPECT_EQ(after.parameters[0].standard_error, 1.0 / 3.0) << "to the digit";
  EXPECT_TRUE(std::isnan(after.parameters[1].standard_error)) << "JSON has no such number";
  EXPECT_TRUE(std::isnan(after.residuals[0].chi_square));
  EXPECT_EQ(after.residuals[0].role, "fit");
  EXPECT_EQ(after.effects, before.effects);
  EXPECT_EQ(after.channels[0].mean, 21.5);
  EXPECT_EQ(after.seconds, 1.5);
}

TEST(NightResult, RefusesWhatIsNone) {
  nlohmann::ordered_json json = to_json(night());
  json.erase("parameters");
  EXPECT_THROW(night_result_from(json), nlohmann::json::exception);
  EXPECT_THROW(night_result_from(nlohmann::ordered_json::array()), nlohmann::json::exception);
}

/// A run, by hand, of a machine whose mass is determined.
RunResult run_of_machine() {
  RunResult run;
  run.wall_time = 2.5;
  run.grade.grade = Grade::usable;
  run.baseline = scattering_machine(2, 0.0, 1, 0.1);
  run.baseline.recordings[1].role = Role::validate;
  run.first.verdict.kind = FitVerdict::Kind::usable;
  run.first.parameters = {
      {{quantity_index("M")}, 12.0, {.determined = true, .standard_error = 0.5}},
      {{quantity_index("B_a")}, 40.0, {}}};
  run.first.recordings.resize(2);
  for (std::size_t r = 0; r < 2; ++r) {
    run.first.recordings[r].signals.resize(1);
    run.first.recordings[r].signals[0].rmse = 1e-3 * static_cast<double>(r + 1);
  }
  return run;
}

TEST(NightResult, HasWhatIsDeterminedAndWhatIsLeft) {
  const NightResult found = night_result(run_of_machine());
  EXPECT_EQ(found.status, "usable");
  EXPECT_EQ(found.seconds, 2.5);
  ASSERT_EQ(found.parameters.size(), 1u);
  EXPECT_EQ(found.parameters[0].name, "M");
  EXPECT_EQ(found.parameters[0].unit, "kg");
  EXPECT_EQ(found.parameters[0].standard_error, 0.5);
  ASSERT_EQ(found.residuals.size(), 2u);
  EXPECT_EQ(found.residuals[0].role, "fit");
  EXPECT_EQ(found.residuals[1].recording, "run-2");
  EXPECT_EQ(found.residuals[1].role, "validate");
  EXPECT_EQ(found.residuals[1].rmse, 2e-3);
}

TEST(NightResult, LeavesOutParametersOfOneRecordingAndOfWrongFits) {
  RunResult run = run_of_machine();
  run.baseline.free[0].recording = 0;
  EXPECT_TRUE(night_result(run).parameters.empty());
  run = run_of_machine();
  run.first.verdict.kind = FitVerdict::Kind::no_minimum;
  EXPECT_TRUE(night_result(run).parameters.empty());
}

// Trends learn an axis' scatter from the nights: within one it would count twice.
TEST(NightResult, ErrorsAreWithoutTheScatter) {
  RunResult run = run_of_machine();
  ParameterScatter scatter;
  scatter.within = 0.125;
  run.scatter.emplace().parameters = {scatter};
  EXPECT_EQ(night_result(run).parameters[0].standard_error, 0.5) << "none was seen";
  run.scatter->parameters[0].deviation = 0.4;
  EXPECT_EQ(night_result(run).parameters[0].standard_error, 0.125);
}

TEST(NightResult, ChannelsHaveTheirMeanOverAllRecordings) {
  RunResult run = run_of_machine();
  run.baseline.model.structure.channels = kept({{"oil", "degC", 20.0}, {"supply", "V", 0.0}});
  run.baseline.recordings[0].channels = {Samples{1.0, 2.0}};
  run.baseline.recordings[1].channels = {Samples{6.0}};
  const NightResult found = night_result(run);
  ASSERT_EQ(found.channels.size(), 1u) << "of the other nothing was recorded";
  EXPECT_EQ(found.channels[0].name, "oil");
  EXPECT_EQ(found.channels[0].mean, 23.0);
}

TEST(NightResult, ASearchAddsWhatItAccepted) {
  NightResult found = night_result(run_of_machine());
  RunResult search = run_of_machine();
  add_search(found, search);
  EXPECT_EQ(found.seconds, 5.0);
  EXPECT_TRUE(found.effects.empty());
  EffectSelection& selection = search.selection.emplace();
  selection.result.job = search.baseline;
  Outcome ripple, drag;
  ripple.hypothesis.name = "periodic_force";
  ripple.reason = Reason::explains_best;
  ripple.parameters = {{{quantity_index("periodic_force.period")}, 0.0361, {}}};
  drag.hypothesis.name = "quadratic_drag";
  drag.reason = Reason::explains_equally;
  selection.effects = {ripple, drag};
  search.grade.grade = Grade::explained;
  add_search(found, search);
  EXPECT_EQ(found.status, "explained");
  EXPECT_EQ(found.effects, std::vector<std::string>{"periodic_force, period 0.0361 m"});
}

}  // namespace
}  // namespace axisfit
