// Fits that begin anywhere.
#include <gtest/gtest.h>

#include <cmath>

#include "fit/estimate/estimate.h"
#include "io/config/job_file.h"
#include "tests/fit/parameter_ids.h"
#include "tests/sim/stress.h"

namespace axisfit {
namespace {

/// The first 0.1 s of the paper's job, with its free quantities anywhere in their whole range.
Job anywhere_job(std::uint64_t draw) {
  static const Job paper = read_job_file(AXISFIT_CONFIGS "/jobs/paper.yaml").job;
  Job job = paper;
  constexpr std::size_t kSamples = 101;
  for (Recording& r : job.recordings) {
    r.times.edit().resize(kSamples);
    for (Measurement& m : r.measurements) {
      m.values.edit().resize(kSamples);
      if (!m.excluded.empty()) m.excluded.resize(kSamples);
    }
  }
  std::mt19937_64 g(draw);
  for (FreeParameter& p : job.free) {
    const Quantity& quantity = quantity_list()[p.quantity].quantity;
    p.lower = std::max(quantity.lower, 1e-12 * quantity.upper);
    p.upper = quantity.upper;
    p.initial = anywhere(g, p.lower, p.upper);
  }
  job.options.threads = 1;
  job.options.max_iterations = 10;
  return job;
}

TEST(StressSlowTest, AFitFromAnywhereEndsWithAVerdict) {
  for (std::uint64_t draw = 0; draw < 100; ++draw) {
    SCOPED_TRACE(draw);
    const FitResult fit = estimate(anywhere_job(draw));
    EXPECT_EQ(fit.is_usable(), fit.verdict.kind == FitVerdict::Kind::usable);
    if (!fit.is_usable()) continue;
    EXPECT_TRUE(std::isfinite(fit.reduced_chi_square));
    for (const ParameterResult& p : fit.parameters)
      EXPECT_TRUE(std::isfinite(p.value)) << name_of(p.id);
  }
}

}  // namespace
}  // namespace axisfit
