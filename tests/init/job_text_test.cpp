#include "init/job_text.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/init/made_job.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

using JobTextTest = InitJobTest;

TEST_F(JobTextTest, NamesCannotBreakOutOfTheFile) {
  const std::string name = "pos: {x}, # \"q\" - 'a' [mm]";
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"i_A", 1.0}, {name, 1e3}, {"- &x *y", 1.0}, {"!!null ~", 1.0}});
  folder_.write("true: # a.csv", table);
  make({"true: # a.csv"});
  const JobFile file = read();
  EXPECT_EQ(file.job.recordings[0].file, "true: # a.csv");
  EXPECT_EQ(file.job.recordings[0].measurements.size(), 1u);
}

TEST_F(JobTextTest, NamesOfAllKindsAreTaken) {
  // A micro sign as Windows has it; a line that Unicode breaks, and a bell, in a name.
  Table table = renamed(driven(), {{"t_s", 1.0},
                                   {"i_A", 1.0},
                                   {"x_m", 1.0},
                                   {"v [\xB5m/s]", 1e6},
                                   {"a\u2028free: \xB0\a", 1.0}});
  folder_.write("a.csv", table);
  make({"a.csv"});
  EXPECT_EQ(read().job.recordings[0].measurements.size(), 1u);
  EXPECT_NE(folder_.read("job.yaml").find("# velocity: {column: \"v [µm/s]\", unit: um/s}"),
            std::string::npos);
  EXPECT_NE(folder_.read("job.yaml").find("# Not used: aâ€¨free: °? (column 5)\n"),
            std::string::npos)
      << folder_.read("job.yaml");
}

TEST_F(JobTextTest, RecordingsOfOneNameGetDifferentOnes) {
  fs::create_directories(folder_.path("one"));
  fs::create_directories(folder_.path("two"));
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"i_A", 1.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
  folder_.write("one/run.csv", table);
  for (double& t : table.columns.front().values) t += 1e-4;  // else it would be the same recording
  folder_.write("two/run.csv", table);
  make({"one/run.csv", "two/run.csv"});
  const JobFile file = read();
  EXPECT_EQ(file.job.recordings[0].file, "one/run.csv");
  EXPECT_NE(file.job.recordings[0].name, file.job.recordings[1].name);
}

TEST_F(JobTextTest, SamplesWithoutTimesHaveARate) {
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"i_A", 1.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
  table.columns.erase(table.columns.begin());
  folder_.write("a.csv", table);
  make({"a.csv"}, {}, {}, {.rate = read_rate("500 Hz")});
  EXPECT_NE(folder_.read("job.yaml").find("    rate: 500 Hz   # "), std::string::npos);
  expect_the_driven_mass(fitted(read()), 1.0 / 60.0);
}

TEST_F(JobTextTest, ADutyNamesItsSupply) {
  Table table = renamed(
      driven(), {{"t_s", 1.0}, {"duty [%]", 5.0}, {"x_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
  table.columns.push_back({"Vbat [V]", std::vector<double>(table.columns[0].values.size(), 20.0)});
  folder_.write("a.csv", table);
  make({"a.csv"});
  const std::string text = folder_.read("job.yaml");
  EXPECT_NE(text.find("supply: {column: \"Vbat [V]\", unit: V}"), std::string::npos) << text;
  expect_the_driven_mass(fitted(read()), 1.0 / 60.0);
}

TEST_F(JobTextTest, TheLoadsEncoderIsASignalOfItsOwn) {
  Table table =
      renamed(driven(),
              {{"t_s", 1.0}, {"i_A", 1.0}, {"motor_pos_m", 1.0}, {"v_mps", 1.0}, {"a_mps2", 1.0}});
  std::vector<double> place = table.columns[2].values;
  for (double& x : place) x *= 1e3;
  table.columns.push_back({"load_pos_mm", place});
  folder_.write("a.csv", table);
  make({"a.csv"});
  EXPECT_NE(folder_.read("job.yaml").find("load_position: {column: load_pos_mm, unit: mm}"),
            std::string::npos)
      << folder_.read("job.yaml");
}

}  // namespace
}  // namespace axisfit
