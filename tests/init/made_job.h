// Jobs that are made for recordings of a driven mass.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fit/estimate/estimate.h"
#include "init/init_job.h"
#include "io/config/job_file.h"
#include "tests/apps/files.h"
#include "tests/apps/fit_job.h"

namespace axisfit {

class InitJobTest : public ::testing::Test {
 protected:
  /// Makes a job in the folder.
  InitialJob make(std::vector<std::string> recordings, const std::string& axis = {},
                  std::optional<double> gain = {}, const Answers& answers = {}) {
    for (std::string& r : recordings)
      if (!std::filesystem::path(r).is_absolute()) r = folder_.path(r);
    InitialJob made = initial_job({.recordings = recordings,
                                   .folder = folder_.path(),
                                   .axis = axis,
                                   .gain = gain,
                                   .answers = answers});
    for (const auto& [name, contents] : made.files) folder_.write(name, contents);
    return made;
  }

  JobFile read() { return read_job_file(folder_.path("job.yaml")); }

  std::map<std::string, double> fitted(const JobFile& file) {
    const FitResult result = estimate(file.job);
    EXPECT_TRUE(result.is_usable()) << result.message;
    std::map<std::string, double> values;
    for (const ParameterResult& p : result.parameters) {
      const std::string& name = file.job.entry(p.id.quantity).name;
      EXPECT_TRUE(p.uncertainty.determined || p.uncertainty.is_at_zero()) << name;
      values[name] = p.value;
    }
    return values;
  }

  /// A driven mass: M = 12 kg, B_a = 40 N s/m, F_c = 15 N and F_0 = 4 N at K_f = 60 N/V.
  Table driven(std::uint64_t seed = 1,
               const LevelsMotion& motion = {{2.0, -2.0, 1.0, -1.5, 0.5, -0.8}, 0.3}) {
    const std::string axis = folder_.write(
        "true.yaml",
        "drive: force_source\ntransmission: rigid\n"
        "parameters: {K_f: 60 N/V, M: 12 kg, B_a: 40 N s/m}\n"
        "effects: {coulomb_friction: {F_c: 15 N}, constant_force: {F_0: 4 N}}\n"
        "instruments: {velocity: {noise: 1 mm/s}, acceleration: {noise: 0.05 m/s^2}}\n"
        "controller: {counts_per_revolution: 3141592}\n");
    return record_levels(axis, motion, 1.8,
                         {Signal::position, Signal::velocity, Signal::acceleration}, 500.0, seed);
  }

  /// Its columns time, command, position, velocity and acceleration, renamed and scaled.
  Table renamed(Table table, const std::vector<std::pair<std::string, double>>& columns) {
    EXPECT_EQ(table.columns.size(), columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c) {
      table.columns[c].name = columns[c].first;
      for (double& x : table.columns[c].values) x *= columns[c].second;
    }
    return table;
  }

  static void expect_the_driven_mass(const std::map<std::string, double>& found, double scale) {
    ASSERT_EQ(found.size(), 4u);
    EXPECT_NEAR(found.at("M"), 12.0 * scale, 0.3 * scale);
    EXPECT_NEAR(found.at("B_a"), 40.0 * scale, 2.0 * scale);
    EXPECT_NEAR(found.at("coulomb_friction.F_c"), 15.0 * scale, 1.0 * scale);
    EXPECT_NEAR(found.at("constant_force.F_0"), 4.0 * scale, 0.5 * scale);
  }

  TempFolder folder_;
};

}  // namespace axisfit
