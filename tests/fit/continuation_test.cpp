#include "fit/continuation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// Recordings of samples so many seconds apart, of that signal.
Job sampled(std::initializer_list<double> intervals, Signal signal) {
  Job job;
  for (const double interval : intervals) {
    Recording& r = job.recordings.emplace_back();
    r.times = instants(100, interval);
    r.measurements.emplace_back().signal = signal;
  }
  return job;
}

TEST(CouplingRate, BeginsAsFirmAsTheSamplingAllows) {
  Job job = sampled({2e-3}, Signal::velocity);
  EXPECT_NEAR(first_coupling_rate(job), 500.0, 1e-9);
  job.recordings[0].measurements.emplace_back().signal = Signal::position;
  EXPECT_NEAR(first_coupling_rate(job), 500.0, 1e-9);
  EXPECT_NEAR(first_coupling_rate(sampled({2e-3}, Signal::position)), 150.0, 1e-9);
  job.options.coupling_rate = 70.0;
  EXPECT_EQ(first_coupling_rate(job), 70.0);
}

TEST(CouplingRate, IsThatOfTheCoarsestRecordingToBeFitted) {
  Job job = sampled({2e-3, 4e-3, 8e-3}, Signal::velocity);
  job.recordings[2].role = Role::validate;
  EXPECT_NEAR(first_coupling_rate(job), 250.0, 1e-9);
}

TEST(CouplingRate, EndsAtZeroUnlessItIsFixed) {
  Job job = sampled({2e-3}, Signal::velocity);
  EXPECT_EQ(last_coupling_rate(job), 0.0);
  job.options.coupling = CouplingMode::none;
  EXPECT_EQ(last_coupling_rate(job), 0.0);
  job.options.coupling = CouplingMode::fixed;
  EXPECT_NEAR(last_coupling_rate(job), 500.0, 1e-9);
}

}  // namespace
}  // namespace axisfit
