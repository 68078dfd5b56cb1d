#include <gtest/gtest.h>

#include <string>

#include "report/text/report_text.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

TEST(SelectionTextTest, ErrorsOfAHeldSimulationStandBesideTheFreeRunningOnes) {
  RunResult run_result;
  EffectSelection& selection = run_result.selection.emplace();
  selection.result.job = rubbing_file().job;
  selection.models.resize(1);
  SignalScore score{{.fitted = true}, SignalErrors{.rmse = 0.5}, SignalErrors{0.25, 3.0, 1.5}};
  run_result.scores = {{.signals = {score}, .forces = {{}, {}}}};
  const auto told = [&] { return on_one_line(selection_text(run_result)); };
  EXPECT_NE(
      told().find("Errors of the tracking simulation, before and after rmse of range red. chi2 "
                  "free-running rmse fitted, fit: velocity baseline 0.25 m/s 3 % 1.5 "
                  "0.5 m/s "),
      std::string::npos)
      << told();
  run_result.scores[0].signals[0].tracking.reset();
  EXPECT_NE(told().find("Errors of the free-running simulation, before and after rmse of range "
                        "red. chi2 fitted, fit: velocity baseline 0.5 m/s 0 % 0 Missing force"),
            std::string::npos)
      << told();
}

/// A search on the rubbing mass, with nothing but the declared model so far.
RunResult searched() {
  RunResult run_result;
  EffectSelection& selection = run_result.selection.emplace();
  selection.result.job = rubbing_file().job;
  selection.models.resize(1);
  run_result.scores = {{.signals = {}, .forces = {{}, {}}}};
  return run_result;
}

Outcome outcome(const char* name, Reason reason) {
  Outcome o;
  o.hypothesis.name = name;
  o.reason = reason;
  o.other = "another";
  return o;
}

TEST(SelectionTextTest, TellsAcceptedEffectsFirst) {
  RunResult run_result = searched();
  run_result.selection->effects = {outcome("drag", Reason::explains_less),
                                   outcome("spring", Reason::explains_equally),
                                   outcome("friction", Reason::replicates)};
  const std::string text = on_one_line(selection_text(run_result));
  EXPECT_TRUE(text.starts_with(
      "Effects tried accepted friction explains the residual best of what the recordings to "
      "validate, fitted by themselves, tell alike undecided spring explains these recordings as "
      "well as another rejected drag explains less than another Errors of the free-running "
      "simulation, before and after"))
      << text;
  run_result.selection->effects.clear();
  EXPECT_TRUE(selection_text(run_result).starts_with("Errors of the free-running simulation"));
}

TEST(SelectionTextTest, TellsWhatWasEstimatedAndWhatOtherRecordingsSayOfIt) {
  RunResult run_result = searched();
  Outcome friction = outcome("coulomb_friction", Reason::replicates);
  friction.parameters = {estimated("coulomb_friction.F_c", 6.0412, 0.12)};
  Replication& found = friction.replication.emplace();
  found.parameters = {estimated("coulomb_friction.F_c", 5.5, 0.0)};
  const auto told = [&] {
    run_result.selection->effects = {friction};
    const std::string text = on_one_line(selection_text(run_result));
    return text.substr(0, text.find(" Errors of"));
  };
  const std::string head =
      "Effects tried accepted coulomb_friction F_c = 6.04 +- 0.12 N: explains the residual best of "
      "what the recordings to validate, fitted by themselves, tell alike";
  const std::string elsewhere = "; the recordings to validate, fitted by themselves, ";
  EXPECT_EQ(told(), head + elsewhere + "tell otherwise: F_c = 5.5 N");
  found.is_near = true;
  EXPECT_EQ(told(), head + elsewhere + "agree, but do not prove it: F_c = 5.5 N");
  found.is_alike = true;
  EXPECT_EQ(told(), head + elsewhere + "tell alike: F_c = 5.5 N");
}

TEST(SelectionTextTest, TellsWhatIsHeld) {
  RunResult run_result = searched();
  Job& job = run_result.selection->result.job;
  std::get<StribeckFriction<double>>(job.model.effects).n = 2.0;
  Outcome stribeck = outcome("stribeck_friction", Reason::replicates);
  stribeck.parameters = {estimated("stribeck_friction.F_st", 6.0412, 0.12)};
  stribeck.hypothesis.shapes = {quantity_index("stribeck_friction.v_st"),
                                quantity_index("stribeck_friction.n")};
  stribeck.hypothesis.held = 1;
  const auto tells = [&](const char* text) {
    run_result.selection->effects = {stribeck};
    return on_one_line(selection_text(run_result)).find(text) != std::string::npos;
  };
  EXPECT_TRUE(tells("F_st = 6.04 +- 0.12 N, n = 2 (held): explains"));
  job.free.push_back(free_parameter("stribeck_friction.n", 2.0));
  EXPECT_TRUE(tells("F_st = 6.04 +- 0.12 N: explains"));
}

// Of its coefficients nobody reads a list.
TEST(SelectionTextTest, ACurveHasTheRangeOfItsCoefficients) {
  RunResult run_result = searched();
  Outcome curve = outcome("curve", Reason::replicates);
  curve.hypothesis.kind = HypothesisKind::curve;
  curve.parameters = {estimated("coulomb_friction.F_c", 2.5, 0.1),
                      estimated("constant_force.F_0", -7.0, 0.1), estimated("F_s", 1.0, 0.1)};
  curve.replication.emplace();
  run_result.selection->effects = {curve};
  EXPECT_NE(on_one_line(selection_text(run_result))
                .find("accepted curve 3 coefficients from -7 to 2.5 N: explains the residual best"),
            std::string::npos)
      << selection_text(run_result);
}

TEST(SelectionTextTest, WhatWasNotSimulatedHasNoErrors) {
  RunResult run_result = searched();
  run_result.selection->models.resize(2);
  run_result.selection->models[1].added = "friction";
  SignalScore score{{.fitted = true}, SignalErrors{0.5, 4.0, 1.25}, {}};
  run_result.scores = {{.signals = {score}, .forces = {{}, {}}},
                       {.signals = {}, .forces = {{}, {}}}};
  EXPECT_NE(on_one_line(selection_text(run_result))
                .find("fitted, fit: velocity baseline 0.5 m/s 4 % 1.25 + friction - - - "),
            std::string::npos)
      << selection_text(run_result);
}

}  // namespace
}  // namespace axisfit
