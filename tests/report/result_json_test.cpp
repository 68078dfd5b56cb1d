// What is told of a fit: result.json, residuals.csv and the text for a terminal.
#include "report/result_json.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "base/version.h"
#include "fit/estimate/estimate.h"
#include "fit/run.h"
#include "io/config/axis_file.h"
#include "io/config/job_file.h"
#include "report/html/report_page.h"
#include "report/text/report_text.h"
#include "report/text/words.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

/// No reader of JSON takes nan or inf, and null is only for what the documentation says may lack.
void expect_finite(const Json& value, const std::string& where) {
  EXPECT_TRUE(!value.is_number() || std::isfinite(value.get<double>())) << where;
  EXPECT_TRUE(!value.is_null() || where.ends_with("standard_error") ||
              where.ends_with("confidence_interval"))
      << where;
  if (value.is_structured())
    for (const auto& [key, entry] : value.items()) expect_finite(entry, where + "/" + key);
}

TEST(ResultTest, JsonHasItsDocumentedKeys) {
  const Json json = Found(fit_job("{starts: 2, seed: 5}")).json;
  // docs/result.md promises these to other programs.
  EXPECT_EQ(keys(json), (std::vector<std::string>{"schema_version",
                                                  "axisfit",
                                                  "status",
                                                  "usable",
                                                  "grade",
                                                  "uses",
                                                  "interrupted",
                                                  "errors_known",
                                                  "time_limit_reached",
                                                  "verdict",
                                                  "message",
                                                  "axis",
                                                  "joint",
                                                  "recordings",
                                                  "parameters",
                                                  "reduced_chi_square",
                                                  "residual",
                                                  "correlation",
                                                  "singular_values",
                                                  "without_influence",
                                                  "weak_directions",
                                                  "combinations",
                                                  "assumptions",
                                                  "observer_gain",
                                                  "horizon_s",
                                                  "stages",
                                                  "starts",
                                                  "minima",
                                                  "iterations",
                                                  "seed",
                                                  "wall_time_s",
                                                  "work"}));
  ASSERT_EQ(json.at("correlation").size(), json.at("parameters").size());
  for (std::size_t i = 0; i < json.at("correlation").size(); ++i)
    EXPECT_DOUBLE_EQ(json.at("correlation")[i][i], 1.0);
  EXPECT_EQ(json.at("singular_values").size(), json.at("parameters").size());
  EXPECT_TRUE(json.at("weak_directions").empty());
  EXPECT_EQ(keys(json.at("residual")),
            (std::vector<std::string>{"explained", "tests", "suspected_effects", "missing_force"}));
  ASSERT_EQ(json.at("residual").at("tests").size(), 2u);
  for (const Json& test : json.at("residual").at("tests"))
    EXPECT_EQ(keys(test),
              (std::vector<std::string>{"recording", "signal", "role", "reduced_chi_square",
                                        "autocorrelation_time", "unexplained_percent", "explained",
                                        "dependences", "outliers", "drift", "resolution"}));
  ASSERT_EQ(json.at("residual").at("missing_force").size(), 2u);
  for (const Json& force : json.at("residual").at("missing_force"))
    EXPECT_EQ(keys(force), (std::vector<std::string>{"recording", "rms_n", "noise_n", "cutoff_hz",
                                                     "drive_rms_n"}));
  for (const Json& recording : json.at("recordings")) {
    EXPECT_EQ(
        keys(recording),
        (std::vector<std::string>{"name", "file", "role", "samples", "start_s", "end_s", "events",
                                  "command_sigma", "command_sigma_source", "warnings", "signals"}));
    for (const Json& signal : recording.at("signals"))
      EXPECT_EQ(keys(signal),
                (std::vector<std::string>{"name", "unit", "fitted", "rmse", "nrmse_percent",
                                          "sigma", "sigma_source", "reduced_chi_square"}));
  }
  for (const Json& parameter : json.at("parameters"))
    EXPECT_EQ(keys(parameter), (std::vector<std::string>{
                                   "name", "unit", "meaning", "value", "verdict", "standard_error",
                                   "confidence_interval", "initial", "lower", "upper", "scale"}));
  expect_finite(json, "");
}

TEST(ResultTest, JsonSaysWhatTheFitFound) {
  const Found fit(fit_job("{starts: 2, seed: 5}"));
  const Json& json = fit.json;
  EXPECT_EQ(json.at("status"), "converged");
  EXPECT_EQ(json.at("usable"), true);
  EXPECT_EQ(json.at("verdict"),
            grade_text(fit.run_result.job(), fit.run_result.grade, fit.run_result.first));
  EXPECT_EQ(json.at("axis"), "x axis of the Automatix AID 600");
  EXPECT_EQ(json.at("axisfit"), version());
  EXPECT_EQ(json.at("seed"), 5);
  EXPECT_EQ(json.at("wall_time_s"), fit.run_result.wall_time);
  EXPECT_GT(fit.run_result.wall_time, 0.0);
  EXPECT_EQ(json.at("iterations"), fit.run_result.first.iterations);
  EXPECT_GT(fit.run_result.first.iterations, 0);
  EXPECT_EQ(json.at("reduced_chi_square"), fit.run_result.first.reduced_chi_square);
  EXPECT_EQ(json.at("observer_gain"), 0.0);
  EXPECT_EQ(json.at("starts").size(), 2u);
  EXPECT_EQ(json.at("stages").size(), fit.run_result.first.stages.size());

  ASSERT_EQ(json.at("recordings").size(), 2u);
  const Json& first = json.at("recordings")[0];
  EXPECT_EQ(first.at("file"), "short.csv");
  EXPECT_EQ(first.at("name"), "short");
  EXPECT_EQ(first.at("role"), "fit");
  EXPECT_EQ(first.at("samples"), 151);
  EXPECT_EQ(first.at("start_s"), 0.0);
  EXPECT_EQ(first.at("end_s"), 0.3);
  EXPECT_EQ(json.at("recordings")[1].at("role"), "validate");
  ASSERT_EQ(first.at("signals").size(), 2u);
  const Json& velocity = first.at("signals")[0];
  const SignalError& error = fit.run_result.first.recordings[0].signals[0];
  EXPECT_EQ(velocity.at("name"), "velocity");
  EXPECT_EQ(velocity.at("unit"), "m/s");
  EXPECT_EQ(velocity.at("fitted"), true);
  EXPECT_EQ(velocity.at("rmse"), error.rmse);
  EXPECT_EQ(velocity.at("nrmse_percent"), error.nrmse_percent);
  EXPECT_EQ(velocity.at("sigma"), 0.002);
  EXPECT_EQ(velocity.at("sigma_source"), "given");
  EXPECT_NEAR(velocity.at("reduced_chi_square"), std::pow(error.rmse / 0.002, 2), 1e-9);
  EXPECT_EQ(first.at("signals")[1].at("fitted"), false);
  EXPECT_EQ(json.at("recordings")[1].at("signals")[0].at("sigma_source"), "differences");

  ASSERT_EQ(json.at("parameters").size(), 2u);
  const Json& damping = json.at("parameters")[0];
  const ParameterResult& found = fit.run_result.first.parameters[0];
  EXPECT_EQ(damping.at("name"), "B_a");
  EXPECT_EQ(damping.at("unit"), "N s/m");
  EXPECT_EQ(damping.at("value"), found.value);
  EXPECT_EQ(damping.at("standard_error"), found.uncertainty.standard_error);
  EXPECT_EQ(damping.at("confidence_interval"),
            Json::array({found.uncertainty.lower, found.uncertainty.upper}));
  EXPECT_EQ(damping.at("initial"), 100.0);
  EXPECT_EQ(damping.at("lower"), 0.0);
  EXPECT_EQ(damping.at("upper"), 1e6);
  EXPECT_EQ(damping.at("scale"), "from_zero");
  EXPECT_EQ(damping.at("verdict"), "determined");
  // The truth, by which the recording was made.
  EXPECT_NEAR(found.value, 200.0, 5.0 * found.uncertainty.standard_error);
  EXPECT_NEAR(fit.run_result.first.parameters[1].value, 2.7,
              5.0 * fit.run_result.first.parameters[1].uncertainty.standard_error);
}

TEST(ResultTest, AParameterAtItsBoundHasAOneSidedInterval) {
  const Found fit(replaced(fit_job(), "{initial: 100 N s/m}",
                           "{initial: 100 N s/m, bounds: [1 N s/m, 120 N s/m]}"));
  const Json& damping = fit.json.at("parameters")[0];
  EXPECT_EQ(damping.at("verdict"), "at bound");
  EXPECT_DOUBLE_EQ(damping.at("value"), 120.0);
  EXPECT_TRUE(damping.at("standard_error").is_null());
  ASSERT_EQ(damping.at("confidence_interval").size(), 2u);
  EXPECT_DOUBLE_EQ(damping.at("confidence_interval")[1], 120.0);
  EXPECT_LT(damping.at("confidence_interval")[0], 120.0);
  EXPECT_NE(fit.text.find("at bound"), std::string::npos);
}

TEST(ResultTest, AFixedCouplingAlsoTellsThePredictionError) {
  const Found fit(fit_job("{observer: {fixed: 100 1/s}}"));
  const Json& velocity = fit.json.at("recordings")[0].at("signals")[0];
  EXPECT_EQ(velocity.at("prediction_rmse"),
            fit.run_result.first.recordings[0].signals[0].prediction_rmse.value());
  EXPECT_TRUE(velocity.contains("prediction_reduced_chi_square"));
  EXPECT_EQ(fit.json.at("observer_gain"), 100.0);
  EXPECT_NE(fit.text.find("prediction rmse"), std::string::npos);
}

TEST(ResultTest, ResidualsAreMeasuredMinusSimulated) {
  const Found fit(fit_job());
  const Csv csv(residuals_csv(fit.run_result.baseline, fit.run_result.first));
  ASSERT_EQ(csv.header, (std::vector<std::string>{
                            "recording", "time_s", "velocity_measured", "velocity_simulated",
                            "velocity_residual", "motor_current_measured",
                            "motor_current_simulated", "motor_current_residual"}));
  ASSERT_EQ(csv.rows.size(), 302u);
  double squares[2][2] = {};  // recording, signal
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    const std::vector<double>& row = csv.rows[i];
    ASSERT_EQ(row.size(), csv.header.size());
    const std::size_t recording = i / 151, sample = i % 151;
    EXPECT_EQ(row[0], static_cast<double>(recording + 1));
    EXPECT_EQ(row[1], fit.run_result.baseline.recordings[recording].times[sample]);
    EXPECT_EQ(row[2], fit.run_result.baseline.recordings[recording].measurements[0].values[sample]);
    EXPECT_NEAR(row[4], row[2] - row[3], 1e-8);
    squares[recording][0] += row[4] * row[4];
    if (recording == 0) {
      EXPECT_NEAR(row[7], row[5] - row[6], 1e-6);
      squares[recording][1] += row[7] * row[7];
    } else {  // has no current
      for (std::size_t column = 5; column < 8; ++column) EXPECT_TRUE(std::isnan(row[column]));
    }
  }
  const auto rmse = [&](std::size_t recording, std::size_t signal) {
    return fit.run_result.first.recordings[recording].signals[signal].rmse;
  };
  EXPECT_NEAR(std::sqrt(squares[0][0] / 151.0) / rmse(0, 0), 1.0, 1e-6);
  EXPECT_NEAR(std::sqrt(squares[0][1] / 151.0) / rmse(0, 1), 1.0, 1e-6);
  EXPECT_NEAR(std::sqrt(squares[1][0] / 151.0) / rmse(1, 0), 1.0, 1e-6);
}

TEST(ResultTest, ARecordingThatCannotBeSimulatedHasNoErrors) {
  // An armature without inertia in a gear with backlash, which run() refuses.
  TempFolder folder;
  write_recordings(folder);
  JobFile file = read_job_file(folder.write("job.yaml", fit_job("{max_iterations: 1}")));
  file.job.model.axis.J_m = 0.0;
  RunResult run_result;
  run_result.baseline = file.job;
  run_result.options.select_effects = true;
  run_result.first = estimate(file.job);
  run_result.checks = check_recordings(file.job);
  run_result.grade = grade_of(file.job, run_result.first, {});
  EXPECT_EQ(run_result.first.verdict.kind, FitVerdict::Kind::not_simulated);
  EXPECT_FALSE(run_result.first.is_usable());
  const Json json = result_json(run_result);
  EXPECT_EQ(json.at("status"), "failed");
  EXPECT_TRUE(json.at("recordings")[0].at("signals")[0].at("rmse").is_null());
  EXPECT_TRUE(json.at("residual").is_null());
  EXPECT_FALSE(json.contains("selection"));
  EXPECT_EQ(json.dump().find("nan"), std::string::npos);
  EXPECT_EQ(json.dump().find("inf,"), std::string::npos);
  const Csv csv(residuals_csv(run_result.job(), run_result.fit()));
  EXPECT_EQ(csv.rows.size(), 302u);
  const std::string text = report_text(run_result);
  EXPECT_NE(text.find(" - "), std::string::npos);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_TRUE(text.ends_with(std::string("\n").append(
      paragraph(grade_text(run_result.job(), run_result.grade, run_result.first)))));
}

TEST(ResultTest, AnExplainedResidualIsSaidToBe) {
  const Found fit(fit_job());
  EXPECT_EQ(fit.json.at("residual").at("explained"), true);
  EXPECT_EQ(fit.json.at("residual").at("suspected_effects"), Json::array());
  EXPECT_EQ(fit.text.find("Suspects"), std::string::npos);
  EXPECT_NE(fit.text.find("\nData that were not fitted are also explained down to the noise. "),
            std::string::npos);
}

TEST(ResultTest, AResidualThatIsNotExplainedNamesItsSuspects) {
  const Found fit(rubbing_job());
  const Json& residual = fit.json.at("residual");
  EXPECT_EQ(residual.at("explained"), false);
  ASSERT_EQ(residual.at("tests").size(), 2u);
  const Json& test = residual.at("tests")[1];
  EXPECT_EQ(test.at("recording"), "judged");
  EXPECT_EQ(test.at("signal"), "velocity");
  EXPECT_EQ(test.at("role"), "validate");
  EXPECT_EQ(test.at("explained"), false);
  EXPECT_GT(test.at("unexplained_percent"), 90.0);
  ASSERT_GE(residual.at("suspected_effects").size(), 1u);
  for (const Json& suspect : residual.at("suspected_effects"))
    EXPECT_EQ(keys(suspect), (std::vector<std::string>{"name", "acts_on", "meaning", "fraction",
                                                       "strengths", "shapes"}));
  const auto rubbing = std::ranges::find_if(
      residual.at("suspected_effects"),
      [](const Json& suspect) { return suspect.at("name") == "coulomb_friction"; });
  ASSERT_NE(rubbing, residual.at("suspected_effects").end());
  EXPECT_EQ(rubbing->at("acts_on"), "friction");
  EXPECT_EQ(keys(rubbing->at("strengths")[0]), (std::vector<std::string>{"name", "unit", "value"}));
  EXPECT_EQ(rubbing->at("strengths")[0].at("name"), "coulomb_friction.F_c");
  EXPECT_GT(rubbing->at("strengths")[0].at("value"), 0.5);
  for (const char* part : {"\nSuspected effects", "\n  coulomb_friction ", "\nUnexplained: up to ",
                           "\nMissing force", "at standstill are excluded"})
    EXPECT_NE(fit.text.find(part), std::string::npos) << part << " in\n" << fit.text;
}

TEST(ResultTest, WhatAResidualDependsOnIsNamed) {
  Found fit(rubbing_job());
  for (SeriesTest& test : fit.run_result.diagnosis->tests) test.dependences.clear();
  fit.run_result.diagnosis->tests[1].dependences = {{"motor angle", 0.25, 1e-9},
                                                    {"load", 0.125, 1e-5}};
  const Json dependences =
      result_json(fit.run_result).at("residual").at("tests")[1].at("dependences");
  ASSERT_EQ(dependences.size(), 2u);
  EXPECT_EQ(dependences[0],
            (Json{{"variable", "motor angle"}, {"fraction", 0.25}, {"p_value", 1e-9}}));
  EXPECT_NE(report_text(fit.run_result).find(" %  motor angle 25 %, load 12 %\n"),
            std::string::npos);
  fit.run_result.diagnosis->explained = true;
  std::string text = report_text(fit.run_result);
  std::ranges::replace(text, '\n', ' ');
  EXPECT_NE(text.find("A small dependence on load, motor angle remains: at most 25 % of the mean "),
            std::string::npos);
}

TEST(ResultTest, ADriftOfUnknownErrorHasNone) {
  Found fit(rubbing_job());
  fit.run_result.diagnosis->tests[1].drift.standard_error = INFINITY;
  const Json drift = result_json(fit.run_result).at("residual").at("tests")[1].at("drift");
  EXPECT_TRUE(drift.at("standard_error").is_null());  // and no infinity, which becomes one in text
  EXPECT_TRUE(drift.at("over_sigma_per_second").is_number());
}

TEST(ResultTest, SamplesAtRestAreCounted) {
  const Found fit(rubbing_job());
  const Json& acceleration = fit.json.at("recordings")[0].at("signals")[1];
  EXPECT_GT(acceleration.at("excluded_samples"), 80);
  EXPECT_NEAR(acceleration.at("excluded_mean"), 0.0, 0.03);
  EXPECT_FALSE(fit.json.at("recordings")[0].at("signals")[0].contains("excluded_samples"));
}

TEST(ResultTest, FaultsOfInstrumentsAreTold) {
  const TempFolder folder;
  write_recordings(folder);
  const Table good = read_csv(folder.path("short.csv"));
  const auto told = [&](auto&& spoil) {
    Table table = good;
    spoil(table.columns[0].values, table.columns[2].values);
    folder.write("short.csv", table, 12);
    const RunResult run_result = run(read_job_file(folder.write("job.yaml", fit_job())).job, {});
    return std::pair{report_text(run_result), result_json(run_result)["residual"]["tests"]};
  };
  using Values = std::vector<double>;
  EXPECT_EQ(told([](const Values&, Values&) {}).first.find("Instruments"), std::string::npos);

  const auto [outlier, outlier_test] = told([](const Values&, Values& v) { v[100] += 0.1; });
  EXPECT_NE(outlier.find("The velocity of short has 1 outlier, "), std::string::npos) << outlier;
  ASSERT_EQ(outlier_test[0].at("outliers").size(), 1u);
  EXPECT_DOUBLE_EQ(outlier_test[0].at("outliers")[0].at("time_s"), good.columns[0].values[100]);
  EXPECT_NEAR(outlier_test[0].at("outliers")[0].at("residual_over_sigma"), 50.0, 5.0);

  const auto [drift, drift_test] = told([](const Values& t, Values& v) {
    for (std::size_t i = 0; i < v.size(); ++i) v[i] += 0.02 * (t[i] - 0.15);
  });
  // The fit takes what it can of it: what it was not fitted to drifts.
  EXPECT_NE(drift.find("The velocity of judge drifts: "), std::string::npos) << drift;
  EXPECT_LT(drift_test[1].at("drift").at("p_value"), 1e-3);

  const auto [resolution, grid_test] = told([](const Values&, Values& v) {
    for (double& x : v) x = 0.01 * std::round(x / 0.01);
  });
  EXPECT_NE(resolution.find("The velocity of short has a resolution of 0.01 m/s."),
            std::string::npos)
      << resolution;
  EXPECT_NEAR(grid_test[0].at("resolution"), 0.01, 1e-9);
}

TEST(ResultTest, OutliersHaveTheTimesOfTheirSamples) {
  Found fit(rubbing_job());
  SeriesTest& test = fit.run_result.diagnosis->tests[1];
  test.series.samples = {10, 20, 50};
  test.series.values = {4.5, 0.5, -7.5};
  test.outliers = {0, 2};
  EXPECT_EQ(result_json(fit.run_result).at("residual").at("tests")[1].at("outliers"),
            Json::parse(R"([{"time_s": 0.04, "residual_over_sigma": 4.5},
                            {"time_s": 0.2, "residual_over_sigma": -7.5}])"));
}

TEST(ResultTest, ASecondOpinionIsToldWhereItContradicts) {
  Found found(rubbing_job());
  ASSERT_TRUE(found.run_result.second_opinion);
  const Json inverse = found.json.at("inverse_dynamics");
  EXPECT_EQ(keys(inverse), (std::vector<std::string>{"start", "exact", "cutoff_hz", "residual_n",
                                                     "drive_rms_n", "parameters"}));
  EXPECT_EQ(inverse.at("start"), "not_tried");
  found.run_result.second_opinion->contradictions = {0};
  EXPECT_EQ(result_json(found.run_result)
                .at("inverse_dynamics")
                .at("parameters")[0]
                .at("contradicts_fit"),
            true);
  EXPECT_NE(on_one_line(report_text(found.run_result))
                .find("Second opinion: inverse dynamics, without a simulation, says M = "),
            std::string::npos);
  found.run_result.inverse_start = InverseStart::better;
  EXPECT_EQ(result_json(found.run_result).at("inverse_dynamics").at("start"), "better");
  for (const std::string& text : {report_text(found.run_result), report_page(found.run_result, {})})
    EXPECT_NE(on_one_line(text).find("The fit began from an inverse-dynamics estimate"),
              std::string::npos);
}

TEST(ResultTest, WhatRestsOnAGuessIsSaid) {
  Found found(rubbing_job());
  EXPECT_FALSE(found.json.at("parameters")[0].contains("rests_on"));
  found.run_result.first.parameters[0].rests_on = {{{quantity_index("K_f")}, 1.0},
                                                   {{quantity_index("F_s")}, -0.25}};
  found.run_result.first.parameters[1].rests_on = {{{quantity_index("K_f")}, -1.0},
                                                   {{quantity_index("F_s")}, 0.3},
                                                   {{quantity_index("T_d")}, -0.4}};
  EXPECT_EQ(result_json(found.run_result).at("parameters")[0].at("rests_on"),
            Json::parse(R"([{"name": "K_f", "elasticity": 1.0},
                            {"name": "F_s", "elasticity": -0.25}])"));
  EXPECT_NE(
      on_one_line(report_text(found.run_result))
          .find(
              "M: known only as a ratio to K_f, which is a guess; rests on a guess: 1 % more of "
              "F_s "
              "makes -0.25 % here. B_a: known only as a product with K_f, which is a guess; rests "
              "on guesses: 1 % more of F_s makes +0.3 % here, of T_d -0.4 %."),
      std::string::npos);
  EXPECT_NE(report_page(found.run_result, {})
                .find("</span> <small>known only as a ratio to K_f, which is a guess; rests on a "
                      "guess: 1 % more "
                      "of F_s makes -0.25 % here</small>"),
            std::string::npos);
}

TEST(ResultTest, TheNextExperimentPredictsWhatIsKnownAfterIt) {
  RunResult run_result = Found(rubbing_job()).run_result;
  run_result.options.suggest_experiment = true;
  Suggestion& s = run_result.suggestion.emplace();
  s.experiment = {.motion = StepMotion{3.0, 0.0}, .duration = 2.0};
  s.limits = {.lowest = -1.0, .highest = 1.0, .speed = 0.5, .command = 10.0};
  s.reach = {.lowest = -0.25, .highest = 0.875, .speed = 0.375};
  const auto known = [](double value, double error) {
    return ParameterUncertainty{.determined = true,
                                .standard_error = error,
                                .lower = value - 2.0 * error,
                                .upper = value + 2.0 * error};
  };
  for (const double value : {4.0, 8.0}) {
    s.predicted.parameters.push_back(known(value, 0.125));
  }
  // What is known now is as in the table of parameters.
  run_result.first.parameters[0].uncertainty = known(4.0, 0.5);
  EXPECT_EQ(result_json(run_result).at("next_experiment").at("predicted"), Json::parse(R"([
    {"name": "M", "standard_error": 0.125, "confidence_interval": [3.75, 4.25]},
    {"name": "B_a", "standard_error": 0.125, "confidence_interval": [7.75, 8.25]}])"));
  EXPECT_NE(on_one_line(suggestion_text(run_result))
                .find("95 % interval now predicted unit M 3.00 .. 5.00 3.75 .. 4.25 kg"),
            std::string::npos)
      << suggestion_text(run_result);
  EXPECT_EQ(result_json(run_result).at("next_experiment").at("reach"),
            Json::parse(R"({"travel_m": [-0.25, 0.875], "speed_mps": 0.375})"));
  EXPECT_NE(on_one_line(suggestion_text(run_result))
                .find("stays within -0.25 .. 0.875 m and 0.375 m/s, 0.12 m and 0.12 m/s from the "
                      "limits."),
            std::string::npos)
      << suggestion_text(run_result);
}

TEST(ResultTest, NoExperimentIsSuggestedWhereNoneIsSafe) {
  RunResult run_result = Found(rubbing_job()).run_result;
  run_result.options.suggest_experiment = true;
  const auto told = [&] { return on_one_line(suggestion_text(run_result)); };
  EXPECT_NE(told().find("no motion that was tried stays within the limits"), std::string::npos);
  run_result.first.parameters[0].uncertainty = {.at_bound = true};
  run_result.baseline.free[0].upper = run_result.first.parameters[0].value;
  EXPECT_NE(told().find("none is suggested, for M is at its bound"), std::string::npos) << told();
  run_result.grade = {.grade = Grade::model_wrong};
  EXPECT_NE(told().find("the simulation does not show what the machine would do"),
            std::string::npos);
  EXPECT_EQ(result_json(run_result).at("next_experiment"), nullptr);
}

TEST(ResultTest, AClosedLoopTellsWhatItAddedAndWhatThatDid) {
  const Found found(rubbing_job(), true);
  const Json& json = found.json;
  EXPECT_EQ(keys(json), (std::vector<std::string>{"schema_version",
                                                  "axisfit",
                                                  "status",
                                                  "usable",
                                                  "grade",
                                                  "uses",
                                                  "interrupted",
                                                  "errors_known",
                                                  "time_limit_reached",
                                                  "verdict",
                                                  "message",
                                                  "axis",
                                                  "joint",
                                                  "recordings",
                                                  "parameters",
                                                  "reduced_chi_square",
                                                  "residual",
                                                  "correlation",
                                                  "singular_values",
                                                  "without_influence",
                                                  "weak_directions",
                                                  "combinations",
                                                  "assumptions",
                                                  "inverse_dynamics",
                                                  "effects",
                                                  "before",
                                                  "after",
                                                  "models",
                                                  "selection",
                                                  "observer_gain",
                                                  "horizon_s",
                                                  "stages",
                                                  "starts",
                                                  "minima",
                                                  "iterations",
                                                  "seed",
                                                  "wall_time_s",
                                                  "work"}));
  EXPECT_EQ(keys(json.at("selection")),
            (std::vector<std::string>{"verdict", "explained", "held_out_blocks", "roles_exchanged",
                                      "hints"}));
  EXPECT_EQ(json.at("selection").at("explained"), true);
  EXPECT_EQ(json.at("selection").at("held_out_blocks"), false);
  int accepted = 0;
  for (const Json& effect : json.at("effects")) {
    std::vector<std::string> known = keys(effect);
    EXPECT_EQ(std::erase(known, "elsewhere") == 1, effect.at("accepted").get<bool>());
    EXPECT_EQ(known, (std::vector<std::string>{"name", "acts_on", "meaning", "decision", "accepted",
                                               "in_model", "reason", "round", "score", "parameters",
                                               "p_value", "validation_improvement_percent"}));
    EXPECT_EQ(effect.at("accepted"), effect.at("decision") == "accepted");
    EXPECT_EQ(effect.at("in_model"), effect.at("accepted"));
    EXPECT_NE(effect.at("reason"), "");
    if (!effect.at("accepted").get<bool>()) continue;
    ++accepted;
    EXPECT_EQ(effect.at("name"), "coulomb_friction");
    EXPECT_EQ(effect.at("parameters")[0].at("name"), "coulomb_friction.F_c");
    EXPECT_NEAR(effect.at("parameters")[0].at("value"), 6.0, 0.1);
    EXPECT_LT(effect.at("p_value"), 1e-3);
    EXPECT_GT(effect.at("validation_improvement_percent"), 50.0);
    EXPECT_EQ(effect.at("elsewhere").at("alike"), true);
    EXPECT_EQ(effect.at("elsewhere").at("agree"), true);
    EXPECT_NEAR(effect.at("elsewhere").at("parameters")[0].at("value"), 6.0, 0.2);
  }
  EXPECT_EQ(accepted, 1);

  ASSERT_EQ(json.at("models").size(), 1u);
  EXPECT_EQ(json.at("models")[0], json.at("after"));
  EXPECT_EQ(json.at("before").at("added"), "");
  EXPECT_EQ(json.at("after").at("added"), "coulomb_friction");
  for (const char* model : {"before", "after"}) {
    EXPECT_EQ(keys(json.at(model)), (std::vector<std::string>{"added", "reduced_chi_square",
                                                              "recordings", "parameters"}));
    for (const Json& recording : json.at(model).at("recordings")) {
      EXPECT_EQ(keys(recording),
                (std::vector<std::string>{"name", "role", "signals", "missing_force"}));
      EXPECT_EQ(keys(recording.at("missing_force")),
                (std::vector<std::string>{"rms_n", "noise_n", "cutoff_hz", "drive_rms_n"}));
      ASSERT_EQ(recording.at("signals").size(), 1u);
      for (const Json& signal : recording.at("signals"))
        EXPECT_EQ(keys(signal), (std::vector<std::string>{"name", "unit", "role", "rmse",
                                                          "nrmse_percent", "reduced_chi_square"}));
    }
    for (const Json& parameter : json.at(model).at("parameters"))
      EXPECT_EQ(keys(parameter),
                (std::vector<std::string>{"name", "unit", "meaning", "value", "verdict",
                                          "standard_error", "confidence_interval"}));
  }
  EXPECT_GT(json.at("before").at("reduced_chi_square"), 10.0);
  EXPECT_LT(json.at("after").at("reduced_chi_square"), 1.5);
  // What stands at the top is the final model's, which is fitted once more.
  EXPECT_NEAR(json.at("reduced_chi_square"), json.at("after").at("reduced_chi_square"), 1e-4);
  ASSERT_EQ(json.at("parameters").size(), 3u);
  EXPECT_EQ(json.at("parameters")[0].at("initial"), 10.0);
  EXPECT_EQ(json.at("parameters")[2].at("name"), "coulomb_friction.F_c");
  for (std::size_t r = 0; r < 2; ++r)
    EXPECT_NEAR(json.at("recordings")[r].at("signals")[0].at("rmse"),
                json.at("after").at("recordings")[r].at("signals")[0].at("rmse"), 1e-6);
  expect_finite(json, "");

  for (const char* part :
       {"  baseline  unit\n", "\n  accepted  coulomb_friction ", "\n  rejected ",
        "\n  judged, validate: velocity\n    baseline ", "\n    + coulomb_friction ",
        "Missing force on the arm, before and after"})
    EXPECT_NE(found.text.find(part), std::string::npos) << part << " in\n" << found.text;

  // residuals.csv and fitted.yaml are of the final model.
  const Csv csv(residuals_csv(found.run_result.job(), found.run_result.fit()));
  double squares = 0.0;
  for (std::size_t i = 0; i < 501; ++i) squares += csv.rows[i][4] * csv.rows[i][4];
  EXPECT_NEAR(std::sqrt(squares / 501.0) /
                  json.at("recordings")[0].at("signals")[0].at("rmse").get<double>(),
              1.0, 1e-5);
  const TempFolder folder;
  Rig fitted = found.rig;
  fitted.model = fitted_model(found.run_result.job(), found.run_result.fit());
  Diagnostics diagnostics;
  const auto again =
      read_axis_file(folder.write("fitted.yaml", format_axis_file(fitted, "")), diagnostics);
  ASSERT_TRUE(again.has_value());
  Model<double> model = again->model;
  EXPECT_EQ(model.structure.effects, fitted.model.structure.effects);
  EXPECT_EQ(*members(model)[quantity_index("coulomb_friction.F_c")],
            json.at("parameters")[2].at("value").get<double>());
}

TEST(ResultTest, BlocksHeldOutAreScoredApart) {
  const Found found(rubbing_job(false), true);
  EXPECT_EQ(found.json.at("selection").at("held_out_blocks"), true);
  const Json& signals = found.json.at("after").at("recordings")[0].at("signals");
  ASSERT_EQ(signals.size(), 2u);
  std::set<std::string> roles;
  for (const Json& s : signals) roles.insert(s.at("role").get<std::string>());
  EXPECT_EQ(roles, (std::set<std::string>{"fit", "held_out"}));
  EXPECT_NE(found.text.find("fitted, held_out: velocity"), std::string::npos);
  EXPECT_NE(found.text.find("No recording has the role validate"), std::string::npos);
}

TEST(ResultTest, TellsThatTheRolesAreExchanged) {
  Found found(rubbing_job(true), true);
  EXPECT_EQ(found.json.at("selection").at("roles_exchanged"), false);
  EXPECT_EQ(found.text.find("exchanged"), std::string::npos);
  found.run_result.roles_exchanged = true;
  const std::string text = report_text(found.run_result);
  EXPECT_NE(text.find("those to validate are fitted"), std::string::npos);
  EXPECT_NE(text.find("exchanged", text.find("Explained. ")), std::string::npos);
  EXPECT_EQ(result_json(found.run_result).at("selection").at("roles_exchanged"), true);
}

}  // namespace
}  // namespace axisfit
