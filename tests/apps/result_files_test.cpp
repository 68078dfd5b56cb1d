#include "apps/result_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/report/found.h"

namespace axisfit {
namespace {

/// The job on the rubbing mass and its fit.
struct Fitted {
  Fitted() {
    const TempFolder folder;
    write_rubbing_mass(folder);
    file = read_job_file(folder.write("job.yaml", rubbing_job()));
    run_result = run(file.job);
  }
  JobFile file;
  RunResult run_result;
};

const Fitted& fitted() {
  static const Fitted once;
  return once;
}

std::string names(const Files& files) {
  std::string text;
  for (const auto& [name, contents] : files) text += name + " ";
  return text;
}

Files files_of(const RunResult& run_result, const std::string& output = "results") {
  return result_files(fitted().file, run_result, "{}",
                      {"fit-params job.yaml", "job.yaml", "", output});
}

TEST(ResultFiles, OfAFitAreFour) {
  const Files files = files_of(fitted().run_result);
  EXPECT_EQ(names(files), "result.json fitted.yaml residuals.csv report.html ");
  EXPECT_EQ(files[0].second, "{}");
  EXPECT_TRUE(files[1].second.starts_with("# Fitted by axisfit ")) << files[1].second;
  EXPECT_NE(files[1].second.find(" from job.yaml, starting from"), std::string::npos);
}

TEST(ResultFiles, AJobGoesOnFromWhatWasAccepted) {
  RunResult run_result = fitted().run_result;
  run_result.baseline.model.structure.effects.set(*effect_named("coulomb_friction"));
  EXPECT_EQ(names(files_of(run_result)),
            "result.json fitted.yaml residuals.csv report.html next-job.yaml ");
  EXPECT_EQ(names(files_of(run_result, "")), "result.json fitted.yaml residuals.csv report.html ");
}

// What a later run may replace it must know again.
TEST(ResultFiles, BeginAsTheirNamesSay) {
  RunResult run_result = fitted().run_result;
  run_result.baseline.model.structure.effects.set(*effect_named("coulomb_friction"));
  const auto known = result_names();
  const Files files = result_files(fitted().file, run_result, result_json(run_result).dump(2),
                                   {"fit-params job.yaml", "job.yaml", "", "results"});
  EXPECT_EQ(files.size(), 5u) << names(files);
  for (const auto& [name, contents] : files) {
    const auto at = std::ranges::find(known, name, &ResultName::name);
    ASSERT_NE(at, known.end()) << name;
    EXPECT_NE(contents.substr(0, 1000).find(at->signature), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace axisfit
