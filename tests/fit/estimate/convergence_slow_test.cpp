// The fit reaches the global minimum from poor starts. Slow: dozens of whole fits.

#include <gtest/gtest.h>

#include <cmath>

#include "fit/estimate/estimate.h"
#include "io/config/job_file.h"
#include "tests/fit/parameter_ids.h"

namespace axisfit {
namespace {

TEST(Convergence, PaperJobFromStartsWithinAFactorOfFive) {
  Job job = read_job_file(std::string(AXISFIT_CONFIGS) + "/jobs/paper.yaml").job;
  std::vector<double> truth;
  for (FreeParameter& p : job.free) {
    p.initial = *members(job.model)[p.quantity];
    p.lower = p.initial / 100.0;
    p.upper = p.initial * 100.0;
    truth.push_back(p.initial);
  }
  constexpr int kStarts = 40;
  int reached = 0;
  for (int start = 1; start <= kStarts; ++start) {
    Job one = job;
    const std::vector<double> from = draw_start(job, start);
    for (std::size_t i = 0; i < from.size(); ++i) one.free[i].initial = from[i];
    const FitResult result = estimate(one);
    if (!result.is_usable() || result.reduced_chi_square >= 1.1) continue;
    ++reached;
    for (std::size_t i = 0; i < truth.size(); ++i)
      EXPECT_LT(std::abs(result.parameters[i].value - truth[i]),
                4.0 * result.parameters[i].uncertainty.standard_error)
          << name_of(result.parameters[i].id);
  }
  EXPECT_GE(reached, 38);
}

}  // namespace
}  // namespace axisfit
