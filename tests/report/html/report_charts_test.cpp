#include "report/html/report_charts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>

#include "tests/report/found.h"

namespace axisfit {
namespace {

const RunResult& rubbing() {
  static const RunResult run_result = Found(rubbing_job()).run_result;
  return run_result;
}

bool has_figure(const Html& html, const std::string& id) {
  return html.text().find("id=\"" + id + "\"") != std::string::npos;
}

TEST(ReportCharts, HaveOneDescriptionEachForTheScript) {
  ReportCharts charts(rubbing());
  EXPECT_TRUE(charts.data().at("charts").empty());
  const Html traces = charts.traces(0);
  std::size_t figures = 0;
  for (std::size_t at = 0; (at = traces.text().find("<figure", at)) != std::string::npos; ++at)
    ++figures;
  EXPECT_EQ(figures, 4u);  // two signals and their residuals
  EXPECT_EQ(charts.data().at("charts").size(), figures);
  for (const char* id : {"trace-velocity-1", "residual-velocity-1", "trace-acceleration-1"})
    EXPECT_TRUE(has_figure(traces, id)) << id;
}

TEST(ReportCharts, OverviewIsOfTheSignalThatIsExplainedLeast) {
  RunResult run_result = rubbing();
  run_result.diagnosis->tests[0].reduced_chi_square = 10.0;
  run_result.diagnosis->tests[1].reduced_chi_square = 20.0;
  EXPECT_NE(ReportCharts(run_result).overview().text().find("Velocity of judged"),
            std::string::npos);
  run_result.diagnosis->tests[0].reduced_chi_square = 30.0;
  EXPECT_NE(ReportCharts(run_result).overview().text().find("Velocity of fitted"),
            std::string::npos);
}

TEST(ReportCharts, OfAMissingForceAreNoneWhereItWasNotFound) {
  RunResult run_result = rubbing();
  EXPECT_TRUE(has_figure(ReportCharts(run_result).missing_force(1), "force-2"));
  run_result.diagnosis->forces[1].found = false;
  EXPECT_TRUE(ReportCharts(run_result).missing_force(1).empty());
}

}  // namespace
}  // namespace axisfit
