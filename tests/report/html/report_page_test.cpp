#include "report/html/report_page.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>

#include "io/config/job_file.h"
#include "tests/apps/files.h"
#include "tests/apps/fit_job.h"

namespace axisfit {
namespace {

std::string page_of(const std::string& job, const RunOptions& run_options = {}) {
  const TempFolder folder;
  write_recordings(folder);
  write_rubbing_mass(folder);
  const RunResult run_result = run(read_job_file(folder.write("job.yaml", job)).job, run_options);
  return report_page(run_result,
                     {"fit-params job.yaml", "job.yaml", job, "x.yaml", "name: <b>x</b>"});
}

/// What a group of the pattern matches in the elements of a page, each once.
std::set<std::string> all_of(const std::string& page, const std::string& pattern) {
  const std::regex regex(pattern);
  const std::string elements = page.substr(0, page.find("<script"));
  std::set<std::string> found;
  for (std::sregex_iterator at(elements.begin(), elements.end(), regex), end; at != end; ++at) {
    const bool first = found.insert((*at)[1]).second;
    EXPECT_TRUE(first) << "twice: " << (*at)[1];
  }
  return found;
}

TEST(ReportPage, HasItsSectionsAndEveryIdOnce) {
  const std::string page = page_of(fit_job());
  EXPECT_EQ(all_of(page, "<section id=\"([^\"]*)\""),
            (std::set<std::string>{"verdict", "recordings", "parameters", "residual", "convergence",
                                   "repeat"}));
  const auto ids = all_of(page, " id=\"([^\"]*)\"");
  EXPECT_TRUE(ids.contains("trace-velocity-1"));
  EXPECT_TRUE(ids.contains("residual-motor_current-1"));
  EXPECT_TRUE(ids.contains("trace-velocity-2"));
  EXPECT_TRUE(ids.contains("1-velocity-over-position"));
  EXPECT_TRUE(ids.contains("force-1"));
  EXPECT_NE(page.find("Explained"), std::string::npos);
}

TEST(ReportPage, TellsTheStoryOfTheLoop) {
  const std::string page = page_of(rubbing_job(), {.select_effects = true});
  const auto ids = all_of(page, " id=\"([^\"]*)\"");
  EXPECT_TRUE(ids.contains("loop"));
  EXPECT_TRUE(ids.contains("before-after-1") || ids.contains("before-after-2"));
  EXPECT_NE(page.find("Round 1"), std::string::npos);
  EXPECT_NE(page.find("<span class=\"badge accepted\">accepted</span>"), std::string::npos);
  EXPECT_NE(page.find("With coulomb_friction: reduced chi-square"), std::string::npos);
  EXPECT_NE(page.find("explained by the added effects"), std::string::npos);
}

TEST(ReportPage, ShowsNoMotorWhereTheAxisHasNone) {
  const std::string with = page_of(fit_job()), without = page_of(rubbing_job());
  for (const char* title : {"Against motor angle", "Against current"}) {
    EXPECT_NE(with.find(title), std::string::npos) << title;
    EXPECT_EQ(without.find(title), std::string::npos) << title;
  }
  EXPECT_EQ(without.find("gear force"), std::string::npos);
  EXPECT_NE(without.find("Against drive force"), std::string::npos);
}

TEST(ReportPage, DrawsProfilesWhereTheyWereComputed) {
  const std::string page = page_of(fit_job(), {.profiles = {{quantity_index("B_a")}}});
  EXPECT_NE(page.find("id=\"profile-1\""), std::string::npos);
  EXPECT_EQ(page.find("id=\"profile-2\""), std::string::npos);
}

TEST(ReportPage, ShowsNamesFromFilesAsText) {
  std::string job = fit_job();
  const std::string name = "<script>alert(1)</script>";
  job.insert(job.find("file: short.csv"), "name: \"" + name + "\"\n    ");
  const std::string page = page_of(job);
  EXPECT_EQ(page.find(name), std::string::npos);
  EXPECT_NE(page.find("velocity of &lt;script&gt;alert(1)&lt;/script&gt;"), std::string::npos);
  EXPECT_EQ(page.find("<b>x</b>"), std::string::npos);
}

TEST(ReportPage, LooksNowhereElse) {
  const std::string page = page_of(fit_job());
  // No address but names of XML.
  EXPECT_EQ(page.find(" src="), std::string::npos);
  EXPECT_EQ(page.find("url(http"), std::string::npos);
  EXPECT_EQ(page.find("<link"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

TEST(ReportPage, OfAFitThatFailedSaysSo) {
  std::string job = fit_job("{max_iterations: 1, observer: none}");
  const std::string page = page_of(job);
  EXPECT_NE(page.find("class=\"verdict "), std::string::npos);
  EXPECT_EQ(page.find("class=\"verdict good\""), std::string::npos);
}

}  // namespace
}  // namespace axisfit
