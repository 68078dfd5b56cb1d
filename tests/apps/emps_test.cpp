// The EMPS benchmark, a real axis: the fit finds what others have found.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "fit/estimate/estimate.h"
#include "io/config/job_file.h"
#include "report/text/names.h"
#include "tests/foreign_recordings.h"

namespace axisfit {
namespace {

// A. Janot, M. Gautier and M. Brunot, "Data Set and Reference Models of EMPS", 2019: least squares
// estimates. Their offset is on the side of the friction, F_0 on that of the force.
TEST(EmpsTest, FitAgreesWithThePublishedEstimates) {
  // Where to get them: configs/jobs/emps.yaml.
  const ForeignRecordings data =
      foreign_recordings("emps", {"DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"});
  if (!data.missing.empty()) GTEST_SKIP() << data.missing;
  const JobFile file = read_job_file(AXISFIT_CONFIGS "/jobs/emps.yaml", data.folder.string());
  const FitResult result = estimate(file.job);
  EXPECT_TRUE(result.verdict.has_minimum());
  EXPECT_TRUE(result.is_usable()) << result.message;

  std::map<std::string, double> value;
  for (const ParameterResult& p : result.parameters) {
    const std::string name = name_of(file.job, p.id);
    value[name] = p.value;
    EXPECT_TRUE(p.uncertainty.determined) << name;
  }
  ASSERT_EQ(value.size(), 4u);
  EXPECT_NEAR(value.at("M"), 95.1089, 0.005 * 95.1089);
  EXPECT_NEAR(value.at("B_a"), 203.5034, 0.03 * 203.5034);
  EXPECT_NEAR(value.at("coulomb_friction.F_c"), 20.3935, 0.03 * 20.3935);
  EXPECT_NEAR(value.at("constant_force.F_0"), 3.1648, 0.10 * 3.1648);

  // The free-running simulation of both recordings stays within a few per cent of the stroke.
  for (const RecordingResult& recording : result.recordings) {
    ASSERT_TRUE(recording.free_running.finished);
    ASSERT_EQ(recording.signals.size(), 1u);
    EXPECT_LT(recording.signals.front().nrmse_percent, 5.0);
  }
}

}  // namespace
}  // namespace axisfit
