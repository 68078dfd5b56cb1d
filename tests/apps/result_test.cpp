// What is told of a fit: result.json, residuals.csv and the text for a terminal.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "apps/job_file.h"
#include "apps/report_text.h"
#include "apps/result_json.h"
#include "apps/version.h"
#include "fit/estimate.h"
#include "tests/apps/files.h"
#include "tests/apps/fit_job.h"

namespace axisfit {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> result;
  for (const auto& [key, value] : object.items()) result.push_back(key);
  return result;
}

/// A job and its fit.
struct Fitted {
  explicit Fitted(const std::string& job) {
    const TempFolder folder;
    write_recordings(folder);
    file = read_job_file(folder.write("job.yaml", job));
    result = estimate(file.job);
    json = result_json(file, result, 0.25);
  }
  JobFile file;
  FitResult result;
  Json json;
};

/// No reader of JSON takes nan or inf, and null is only for what the documentation says may lack.
void expect_finite(const Json& value, const std::string& where) {
  EXPECT_TRUE(!value.is_number() || std::isfinite(value.get<double>())) << where;
  EXPECT_FALSE(value.is_null()) << where;
  if (value.is_structured())
    for (const auto& [key, entry] : value.items()) expect_finite(entry, where + "/" + key);
}

TEST(ResultTest, JsonHasItsDocumentedKeys) {
  const Json json = Fitted(fit_job("{starts: 2, seed: 5}")).json;
  // docs/result.md promises these to other programs.
  EXPECT_EQ(keys(json), (std::vector<std::string>{"version", "status", "usable", "verdict",
                                                  "message", "axis", "recordings", "parameters",
                                                  "reduced_chi_square", "coupling_rate", "stages",
                                                  "starts", "iterations", "seed", "wall_time_s"}));
  for (const Json& recording : json.at("recordings")) {
    EXPECT_EQ(keys(recording), (std::vector<std::string>{"name", "file", "role", "samples",
                                                         "start_s", "end_s", "events", "signals"}));
    for (const Json& signal : recording.at("signals"))
      EXPECT_EQ(keys(signal),
                (std::vector<std::string>{"name", "unit", "fitted", "rmse", "nrmse_percent",
                                          "sigma", "sigma_source", "reduced_chi_square"}));
  }
  for (const Json& parameter : json.at("parameters"))
    EXPECT_EQ(keys(parameter),
              (std::vector<std::string>{"name", "unit", "meaning", "value", "determined",
                                        "standard_error", "confidence_interval", "initial", "lower",
                                        "upper", "scale", "at_bound"}));
  expect_finite(json, "");
}

TEST(ResultTest, JsonSaysWhatTheFitFound) {
  const Fitted fit(fit_job("{starts: 2, seed: 5}"));
  const Json& json = fit.json;
  EXPECT_EQ(json.at("status"), "converged");
  EXPECT_EQ(json.at("usable"), true);
  EXPECT_EQ(json.at("verdict"), fit.result.verdict);
  EXPECT_EQ(json.at("axis"), "x axis of the Automatix AID 600");
  EXPECT_EQ(json.at("version"), kVersion);
  EXPECT_EQ(json.at("seed"), 5);
  EXPECT_EQ(json.at("wall_time_s"), 0.25);
  EXPECT_EQ(json.at("iterations"), fit.result.iterations);
  EXPECT_GT(fit.result.iterations, 0);
  EXPECT_EQ(json.at("reduced_chi_square"), fit.result.reduced_chi_square);
  EXPECT_EQ(json.at("coupling_rate"), 0.0);
  EXPECT_EQ(json.at("starts").size(), 2u);
  EXPECT_EQ(json.at("stages").size(), fit.result.stages.size());

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
  const SignalError& error = fit.result.recordings[0].signals[0];
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
  const ParameterResult& found = fit.result.parameters[0];
  EXPECT_EQ(damping.at("name"), "B_a");
  EXPECT_EQ(damping.at("unit"), "N s/m");
  EXPECT_EQ(damping.at("value"), found.value);
  EXPECT_EQ(damping.at("standard_error"), found.uncertainty.standard_error);
  EXPECT_EQ(damping.at("confidence_interval"),
            Json::array({found.uncertainty.lower, found.uncertainty.upper}));
  EXPECT_EQ(damping.at("initial"), 100.0);
  EXPECT_EQ(damping.at("lower"), 1.0);
  EXPECT_EQ(damping.at("upper"), 10000.0);
  EXPECT_EQ(damping.at("scale"), "log");
  EXPECT_EQ(damping.at("at_bound"), false);
  // The truth, by which the recording was made.
  EXPECT_NEAR(found.value, 200.0, 5.0 * found.uncertainty.standard_error);
  EXPECT_NEAR(fit.result.parameters[1].value, 2.7,
              5.0 * fit.result.parameters[1].uncertainty.standard_error);
}

TEST(ResultTest, AParameterAtItsBoundHasNoStandardError) {
  const Fitted fit(replaced(fit_job(), "{initial: 100 N s/m}",
                            "{initial: 100 N s/m, bounds: [1 N s/m, 120 N s/m]}"));
  const Json& damping = fit.json.at("parameters")[0];
  EXPECT_EQ(damping.at("at_bound"), true);
  EXPECT_DOUBLE_EQ(damping.at("value"), 120.0);
  EXPECT_TRUE(damping.at("standard_error").is_null());
  EXPECT_TRUE(damping.at("confidence_interval").is_null());
  EXPECT_NE(report_text(fit.file, fit.result).find("at bound"), std::string::npos);
}

TEST(ResultTest, AFixedCouplingAlsoTellsThePredictionError) {
  const Fitted fit(fit_job("{coupling: {fixed: 100 1/s}}"));
  const Json& velocity = fit.json.at("recordings")[0].at("signals")[0];
  EXPECT_EQ(velocity.at("prediction_rmse"),
            fit.result.recordings[0].signals[0].prediction_rmse.value());
  EXPECT_TRUE(velocity.contains("prediction_reduced_chi_square"));
  EXPECT_EQ(fit.json.at("coupling_rate"), 100.0);
  EXPECT_NE(report_text(fit.file, fit.result).find("predicted rmse"), std::string::npos);
}

TEST(ResultTest, ReportHasEveryFreeParameterAndTheVerdict) {
  const Fitted fit(fit_job());
  const std::string text = report_text(fit.file, fit.result);
  for (const char* part : {"B_a  arm viscous friction", "V_L  preamplifier limit", "N s/m", "short",
                           "judge", "validate", "compare", "motor_current", "151 samples",
                           "* estimated from differences of the samples"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  EXPECT_TRUE(text.ends_with("\n" + fit.result.verdict + "\n"));
  EXPECT_EQ(text.find("nan"), std::string::npos);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_FALSE(line.ends_with(' ')) << line;
    EXPECT_EQ(line.find('\t'), std::string::npos);
  }
}

/// A CSV text with empty fields as NaN.
struct Csv {
  explicit Csv(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::vector<std::string> fields(1);
      for (const char c : line) {
        if (c == ',')
          fields.emplace_back();
        else
          fields.back() += c;
      }
      if (header.empty()) {
        header = fields;
        continue;
      }
      rows.emplace_back();
      for (const std::string& f : fields)
        rows.back().push_back(f.empty() ? std::nan("") : std::strtod(f.c_str(), nullptr));
    }
  }
  std::vector<std::string> header;
  std::vector<std::vector<double>> rows;
};

TEST(ResultTest, ResidualsAreMeasuredMinusSimulated) {
  const Fitted fit(fit_job());
  const Csv csv(residuals_csv(fit.file.job, fit.result));
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
    EXPECT_EQ(row[1], fit.file.job.recordings[recording].times[sample]);
    EXPECT_EQ(row[2], fit.file.job.recordings[recording].measurements[0].values[sample]);
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
    return fit.result.recordings[recording].signals[signal].rmse;
  };
  EXPECT_NEAR(std::sqrt(squares[0][0] / 151.0) / rmse(0, 0), 1.0, 1e-6);
  EXPECT_NEAR(std::sqrt(squares[0][1] / 151.0) / rmse(0, 1), 1.0, 1e-6);
  EXPECT_NEAR(std::sqrt(squares[1][0] / 151.0) / rmse(1, 0), 1.0, 1e-6);
}

TEST(ResultTest, ARecordingThatCannotBeSimulatedHasNoErrors) {
  // Reading a job refuses an armature without inertia in a gear with backlash.
  TempFolder folder;
  write_recordings(folder);
  JobFile file = read_job_file(folder.write("job.yaml", fit_job("{max_iterations: 1}")));
  file.job.model.axis.J_m = 0.0;
  const FitResult result = estimate(file.job);
  EXPECT_EQ(result.status, Status::failed);
  EXPECT_FALSE(result.usable);
  const Json json = result_json(file, result, 0.0);
  EXPECT_EQ(json.at("status"), "failed");
  EXPECT_TRUE(json.at("recordings")[0].at("signals")[0].at("rmse").is_null());
  EXPECT_EQ(json.dump().find("nan"), std::string::npos);
  EXPECT_EQ(json.dump().find("inf"), std::string::npos);
  const Csv csv(residuals_csv(file.job, result));
  EXPECT_EQ(csv.rows.size(), 302u);
  EXPECT_NE(report_text(file, result).find(" - "), std::string::npos);
  EXPECT_EQ(report_text(file, result).find("nan"), std::string::npos);
}

}  // namespace
}  // namespace axisfit
