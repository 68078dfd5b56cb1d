#include "report/text/report_text.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "fit/design/forecast.h"
#include "report/text/words.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

TEST(ReportTextTest, ReportHasEveryFreeParameterAndTheVerdict) {
  const Found fit(fit_job());
  const std::string& text = fit.text;
  for (const char* part : {"B_a  arm viscous friction", "V_L  preamplifier limit", "N s/m", "short",
                           "judge", "validate", "compare", "motor_current", "151 samples",
                           "* estimated from differences of the samples"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  EXPECT_NE(text.find("\n" + paragraph(grade_text(fit.run_result.baseline, fit.run_result.grade,
                                                  fit.run_result.first))),
            std::string::npos);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_FALSE(line.ends_with(' ')) << line;
    EXPECT_EQ(line.find('\t'), std::string::npos);
  }
}

TEST(ReportTextTest, LongNamesAndNumbersFitInTheWidth) {
  const TempFolder folder;
  write_recordings(folder);
  std::string text = fit_job("{observer: {fixed: 100 1/s}}");
  text =
      replaced(text, "file: short.csv\n", "file: short.csv\n    name: a_recording_of_many_words\n");
  text = replaced(text, "free:\n",
                  "effects: {quadratic_drag: {c: 1 N s^2/m^2}, directional_friction: {dB_a: 1 N "
                  "s/m}, coulomb_friction: {F_c: 1 N}}\nfree:\n"
                  "  directional_friction.dB_a: {}\n  coulomb_friction.F_c: {}\n"
                  "  quadratic_drag.c: {initial: 1 N s^2/m^2}\n");
  RunResult run_result = run(read_job_file(folder.write("job.yaml", text)).job,
                             {.profiles = {{quantity_index("V_L")}}});
  expect_narrow(
      forecast_text(run_result.job(), forecast(run_result.job(), draw_start(run_result.job(), 0))));
  for (ParameterResult& p : run_result.first.parameters) {
    p.value = -5000311.7;
    p.uncertainty = {
        .determined = true, .standard_error = 2812.3, .lower = -5005812.0, .upper = -4994890.0};
  }
  const std::string report = report_text(run_result);
  expect_narrow(report);
  EXPECT_NE(report.find("\n  directional_friction.dB_a\n"), std::string::npos) << report;
  EXPECT_NE(report.find("-5.0058e+06 .. -4.9949e+06"), std::string::npos) << report;
}

}  // namespace
}  // namespace axisfit
