#include "fit/estimate/continuation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

ContinuationResult one_continuation(Job job) {
  job.options.attempts = 1;
  const ParameterSpace space(job);
  return run_continuation(job, space, space.internal(draw_start(job, 0)));
}

// A model that lacks much leaves the data when the observer gain falls: by leaps, if in large
// steps.
TEST(Continuation, TakesShorterStepsWhereTheSimulationWouldLoseTheData) {
  Model<double> truth = slide();
  add_effect<CoulombFriction>(truth).F_c = 60.0;
  const ContinuationResult result = one_continuation(two_recordings(truth, slide(), {"M"}));
  double gain = result.stages.front().observer_gain, cost = result.stages.front().reduced_cost;
  int refused = 0;
  for (const Stage& stage : std::span(result.stages).subspan(1)) {
    EXPECT_LT(stage.observer_gain, gain);
    const bool leap = stage.reduced_cost > 3.0 * cost + 1.0;
    if (stage.accepted) {
      EXPECT_TRUE(!leap || gain < 1.3 * stage.observer_gain) << stage.observer_gain;
      gain = stage.observer_gain;
      cost = stage.reduced_cost;
    } else {
      EXPECT_TRUE(leap) << stage.observer_gain;
      ++refused;
    }
  }
  EXPECT_EQ(gain, 0.0);
  EXPECT_GE(refused, 2);
}

// The limit of a drive hardly shows at a high gain and in so much noise, which here would drive it
// to where it is never reached: from there no free run finds back.
TEST(Continuation, LeavesWhatAHighGainDoesNotShowWhereItIs) {
  for (const std::uint64_t seed : {1u, 3u}) {
    Job job;
    job.model = motor_axis();
    job.recordings = {
        recorded(job.model, StepMotion{10.0, 0.0}, 0.4, 1, {Signal::velocity}, false)};
    Measurement& m = job.recordings[0].measurements[0];
    m.sigma = 1.0;  // m/s
    Normal normal(seed);
    for (double& v : m.values.edit()) v += m.sigma * normal();
    job.free = {free_parameter("V_L", 10.0)};
    const ContinuationResult result = one_continuation(job);
    EXPECT_NEAR(std::exp(result.last.u[0]), 8.0, 1.5) << seed;
  }
}

}  // namespace
}  // namespace axisfit
