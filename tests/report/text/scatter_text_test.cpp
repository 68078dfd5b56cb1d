#include <gtest/gtest.h>

#include "report/text/report_text.h"
#include "tests/fit/scattering.h"

namespace axisfit {
namespace {

TEST(ScatterTextTest, NamesTheRecordingWithTheStretches) {
  Job job = scattering_machine(2, 0.0, 6, 6.0);
  job.recordings[0].role = Role::validate;
  const std::string text = scatter_text(run(job));
  EXPECT_NE(text.find("Scatter between 6 stretches of run-2\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace axisfit
