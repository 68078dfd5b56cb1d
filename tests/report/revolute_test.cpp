// All that is told of an axis that turns is in its own words and units.
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <sstream>

#include "fit/run.h"
#include "io/config/axis_file.h"
#include "io/config/job_file.h"
#include "io/config/next_job.h"
#include "report/html/report_page.h"
#include "report/result_json.h"
#include "report/text/names.h"
#include "report/text/report_text.h"
#include "tests/apps/files.h"
#include "tests/apps/fit_job.h"

namespace axisfit {
namespace {

/// A servo that turns a pendulum, driven by a recorded torque; its friction is not declared.
class RevoluteAxis : public ::testing::Test {
 protected:
  RevoluteAxis() {
    const std::string declared =
        "name: servo\njoint: revolute\ndrive: torque_source\ntransmission: rigid\n"
        "parameters: {K_f: 1 N m/V, J: 24 g m^2, B_a: 0.05 N m s/rad}\n"
        "effects:\n  pendulum_gravity: {G_s: 0.7 N m, G_c: 0.1 N m}\n";
    const std::string noise =
        "instruments: {position: {noise: 0.02 deg}, velocity: {noise: 0.5 deg/s}}\n"
        "controller: {limit: 100 V}\n";
    folder_.write("axis.yaml", declared);
    const std::string truth =
        folder_.write("true.yaml", declared + "  coulomb_friction: {T_c: 0.08 N m}\n" + noise);
    const auto write = [&](const std::string& file, const LevelsMotion& motion,
                           std::uint64_t seed) {
      Table table =
          record_levels(truth, motion, 3.0, {Signal::position, Signal::velocity}, 200.0, seed);
      EXPECT_EQ(table.columns[2].name, "position_rad");
      EXPECT_EQ(table.columns[3].name, "velocity_radps");
      folder_.write(file, table, 9);
    };
    write("fit.csv", {{0.8, -0.6, 0.9, -0.9, 0.3, -0.5}, 0.5}, 1);
    write("judge.csv", {{-0.7, 0.9, -0.4, 0.6, -0.9}, 0.6}, 2);
    const auto recording = [](const std::string& file, const std::string& role) {
      return "  - {file: " + file + ", role: " + role +
             ", time: {column: time_s, unit: s}, signals: {\n"
             "      drive_torque: {column: command_v, unit: N m, hold: zero_order, sigma: 0 N m},\n"
             "      position: {column: position_rad, unit: rad},\n"
             "      velocity: {column: velocity_radps, unit: rad/s}}}\n";
    };
    job_ = "axis: axis.yaml\nrecordings:\n" + recording("fit.csv", "fit") +
           recording("judge.csv", "validate") +
           "free:\n  J: {initial: 30 g m^2}\n  B_a: {initial: 0.1 N m s/rad}\n"
           "  pendulum_gravity.G_s:\n  pendulum_gravity.G_c:\n"
           "limits: {travel: [-10 rad, 10 rad], speed: 1000 deg/s}\n";
  }

  /// No metre, newton or kilogram, nor what goes with them. Of an HTML page, only what is read.
  static void expect_turning(const std::string& what, const std::string& text) {
    static const std::regex sliding(
        R"(\b(forces?|Force|mass|arm|stroke|newtons?)\b|[0-9"] ?(N|m|m/s|kg|N s/m)(?=[",.<\s]))"
        R"(|_(n|mps|kg|m)\b|\b[fF]orce_|\bF_[a-z0]\b)");
    std::vector<std::string> found;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      for (std::sregex_iterator at(line.begin(), line.end(), sliding), end; at != end; ++at) {
        // Newton metres and kg m^2 are what it should be.
        const std::string with_next = at->str() + at->suffix().str().substr(0, 4);
        if (with_next.find("N m") != std::string::npos ||
            with_next.find("kg m^2") != std::string::npos)
          continue;
        const auto from =
            static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at->position() - 40));
        found.push_back(line.substr(from, 80));
      }
    EXPECT_TRUE(found.empty()) << what << ":\n" << fmt::format("{}", fmt::join(found, "\n----\n"));
  }

  TempFolder folder_;
  std::string job_;
};

TEST_F(RevoluteAxis, IsFittedAndToldInItsOwnWords) {
  const JobFile file = read_job_file(folder_.write("job.yaml", job_));
  const RunResult found = run(file.job, {.select_effects = true, .suggest_experiment = true});
  ASSERT_TRUE(found.selection);
  EXPECT_EQ(found.selection->verdict.accepted, std::vector<std::string>{"coulomb_friction"});
  const auto expect_near = [&](const std::string& name, double truth) {
    const auto at = std::ranges::find(found.fit().parameters, name, [&](const ParameterResult& p) {
      return name_of(found.job(), p.id);
    });
    ASSERT_NE(at, found.fit().parameters.end()) << name;
    EXPECT_NEAR(at->value, truth, 4.0 * at->uncertainty.standard_error) << name;
    EXPECT_LT(at->uncertainty.standard_error, 0.05 * truth) << name;
  };
  expect_near("J", 0.024);
  expect_near("B_a", 0.05);
  expect_near("coulomb_friction.T_c", 0.08);
  expect_near("pendulum_gravity.G_s", 0.7);

  expect_turning("text", report_text(found));
  expect_turning("result.json", result_json(found).dump(1));
  expect_turning("residuals.csv",
                 residuals_csv(found.job(), found.fit(), found.diagnosis).substr(0, 400));
  Rig fitted = file.rig;
  fitted.model = fitted_model(found.job(), found.fit());
  const std::string axis = format_axis_file(fitted, "");
  expect_turning("fitted.yaml", axis);
  Diagnostics diagnostics;
  EXPECT_TRUE(read_axis_file(folder_.write("again.yaml", axis), diagnostics));
  expect_turning("next-job.yaml", next_job_text(file, found.job(), folder_.path("job.yaml"), "",
                                                folder_.path(), "again.yaml", "Goes on."));
  const std::string page = report_page(found, {});
  const std::size_t from = page.find("<main");
  std::string read;
  bool is_tag = false;
  for (const char c : page.substr(from, page.find("<script", from) - from)) {
    if (c == '<' || c == '>') is_tag = c == '<';
    if (!is_tag) read += c == '>' ? '\n' : c;
  }
  expect_turning("report.html", read);
}

TEST_F(RevoluteAxis, RefusesTheWordsOfALoadThatSlides) {
  const auto error = [&](const std::string& from, const std::string& to) {
    std::string changed = job_;
    changed.replace(changed.find(from), from.size(), to);
    try {
      read_job_file(folder_.write("job.yaml", changed));
    } catch (const ConfigError& e) {
      return folder_.without_path(e.what());
    }
    return std::string("taken");
  };
  EXPECT_NE(error("  J: {initial", "  M: {initial").find("unknown quantity 'M'"),
            std::string::npos);
  EXPECT_EQ(error("unit: rad}", "unit: deg}"), "taken");
  EXPECT_NE(error("unit: rad}", "unit: mm}").find("rad"), std::string::npos)
      << error("unit: rad}", "unit: mm}");
  EXPECT_NE(error("drive_torque", "drive_force").find("drive_torque"), std::string::npos)
      << error("drive_torque", "drive_force");
}

}  // namespace
}  // namespace axisfit
