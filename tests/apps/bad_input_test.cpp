// Bad input, case by case of testdata/bad/cases.yaml, to the program as its users run it.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <string>
#include <vector>

#include "io/config/job_file.h"
#include "tests/apps/bad_cases.h"
#include "tests/apps/shell.h"

namespace axisfit {
namespace {

class BadInputTest : public ::testing::Test {
 protected:
  static void expect_same(const Job& job, const Job& good, double within) {
    ASSERT_EQ(job.recordings.size(), good.recordings.size());
    const Recording &read = job.recordings[0], &wanted = good.recordings[0];
    const auto expect_near = [&](const std::vector<double>& a, const std::vector<double>& b) {
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LE(std::abs(a[i] - b[i]), within);
    };
    expect_near(read.times, wanted.times);
    expect_near(read.command.times, wanted.command.times);
    EXPECT_EQ(read.command.values, wanted.command.values);
    ASSERT_EQ(read.measurements.size(), wanted.measurements.size());
    EXPECT_EQ(read.measurements[0].values, wanted.measurements[0].values);
    EXPECT_EQ(read.measurements[0].sigma, wanted.measurements[0].sigma);
    ASSERT_EQ(job.free.size(), good.free.size());
    for (std::size_t i = 0; i < job.free.size(); ++i)
      EXPECT_EQ(job.free[i].initial, good.free[i].initial);
  }

  void check(const YAML::Node& node) const {
    const TempFolder folder;
    for (const auto& [name, contents] : cases_.files_of(node)) folder.write(name, contents);
    if (node["read"]) {
      const TempFolder good;
      for (const auto& [name, contents] : cases_.good()) good.write(name, contents);
      const bool same = node["read"].Scalar() == "the same";
      expect_same(read_job_file(folder.path("job.yaml")).job,
                  read_job_file(good.path("job.yaml")).job, same ? 0.0 : 1e-6);
    }
    // For those who wait for ever.
    const Answer answer =
        shell(folder, "timeout -k 1 100 fit-params " +
                          (node["run"] ? node["run"].Scalar() : std::string("job.yaml --check")));
    if (node["refused"]) {
      EXPECT_EQ(answer.exit_code, 2);
      EXPECT_EQ(answer.err, node["refused"].Scalar() + "\n");
      EXPECT_EQ(answer.out, "");
      return;
    }
    EXPECT_EQ(answer.exit_code, node["exit"] ? node["exit"].as<int>() : 0) << answer.err;
    for (const auto& words : node["says"])
      EXPECT_NE((answer.out + answer.err).find(words.Scalar()), std::string::npos)
          << words.Scalar() << " is not said:\n"
          << answer.out << answer.err;
  }

  void check_all(const std::string& family) const {
    for (const YAML::Node& node : cases_.family(family)) {
      SCOPED_TRACE(family + ": " + node["name"].Scalar());
      try {
        check(node);
      } catch (const std::exception& error) {
        ADD_FAILURE() << error.what();
      }
    }
  }

  const BadCases cases_{AXISFIT_TESTDATA "/bad/cases.yaml"};
};

TEST_F(BadInputTest, Recordings) { check_all("recordings"); }
TEST_F(BadInputTest, UnusualRecordingsAreRead) { check_all("unusual"); }
TEST_F(BadInputTest, MatlabFiles) { check_all("matlab"); }
TEST_F(BadInputTest, Jobs) { check_all("jobs"); }
TEST_F(BadInputTest, Axes) { check_all("axes"); }
TEST_F(BadInputTest, Fits) { check_all("fits"); }

}  // namespace
}  // namespace axisfit
