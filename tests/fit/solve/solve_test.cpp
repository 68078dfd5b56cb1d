#include "fit/solve/solve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

constexpr double kM = 26.0, kB_a = 18.0;

/// Two recordings to be fitted, of three measurements that are and one that is not, about one that
/// validates. Samples of the first are held out, and the mass is known beforehand.
Job several_series() {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  job.recordings.push_back(job.recordings[0]);
  job.recordings[0].held_out.assign(job.recordings[0].times.size(), false);
  for (std::size_t i = 300; i < 400; ++i) job.recordings[0].held_out[i] = true;
  job.recordings[2].name = "again";
  job.recordings[2].measurements[0].fitted = false;
  job.free[0].prior = Prior{21.0, 0.5};
  return job;
}

Eigen::VectorXd elsewhere(const ParameterSpace& space) { return space.internal({{kM, kB_a}}); }

TEST(Linearize, HasTheSeriesInTheOrderOfTheRecordingsAndThenThePriors) {
  const Job job = several_series();
  const ParameterSpace space(job);
  const Eigen::VectorXd u = elsewhere(space);
  const Linearization at = linearize(job, space, u, 0.0);
  ASSERT_TRUE(at.finite);
  ASSERT_EQ(at.series.size(), 3u);
  const std::pair<std::size_t, std::size_t> places[] = {{0, 0}, {0, 1}, {2, 1}};
  Eigen::Index row = 0;
  for (std::size_t s = 0; s < at.series.size(); ++s) {
    const auto [r, m] = places[s];
    EXPECT_EQ(at.series[s].recording, r);
    EXPECT_EQ(at.series[s].measurement, m);
    EXPECT_EQ(at.series[s].first, row);
    const Recording& recording = job.recordings[r];
    const Measurement& measured = recording.measurements[m];
    const SimulatedRecording run = simulate_recording(job, space, r, u.data(), {});
    for (std::size_t i = 0; i < recording.times.size(); ++i) {
      if (!recording.fits(measured, i)) continue;
      const double error = measured.values[i] - run.simulated[m][i];
      EXPECT_NEAR(at.residuals[row++], error / measured.sigma, 1e-6);  // rounding
    }
    EXPECT_EQ(at.series[s].count, row - at.series[s].first);
  }
  ASSERT_EQ(at.residuals.size(), row + 1);
  EXPECT_NEAR(at.residuals[row], (kM - 21.0) / 0.5, 1e-12);
  EXPECT_EQ(at.jacobian.rows(), row + 1);
}

TEST(Linearize, OfASolutionIsThatAtItsPoint) {
  const Job job = several_series();
  const ParameterSpace space(job);
  SolveResult solved = solve(job, space, elsewhere(space), 0.0, {});
  ASSERT_TRUE(solved.usable && solved.at_solution);
  const Linearization there = linearize(job, space, solved.u, 0.0);
  const auto expect_same = [&](const Linearization& at) {
    EXPECT_TRUE(at.finite);
    EXPECT_EQ(at.residuals, there.residuals);
    EXPECT_EQ(at.jacobian, there.jacobian);
    ASSERT_EQ(at.series.size(), there.series.size());
    for (std::size_t s = 0; s < at.series.size(); ++s)
      EXPECT_EQ(at.series[s].first, there.series[s].first);
  };
  expect_same(linearize(job, space, solved, 0.0));
  solved.at_solution.reset();  // as from a journal
  expect_same(linearize(job, space, solved, 0.0));
}

TEST(ResidualsAt, AreThoseOfTheLinearization) {
  const Job job = several_series();
  const ParameterSpace space(job);
  const Eigen::VectorXd u = elsewhere(space), alone = residuals_at(job, space, u, 0.0),
                        with_jacobian = linearize(job, space, u, 0.0).residuals;
  ASSERT_EQ(alone.size(), with_jacobian.size());
  EXPECT_LT((alone - with_jacobian).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(ResidualsAt, AreNoneWhereASimulationDoesNotFinish) {
  Job job = several_series();
  job.recordings[2].overrides.emplace_back(quantity_index("K_f"), std::nan(""));
  const ParameterSpace space(job);
  EXPECT_EQ(residuals_at(job, space, elsewhere(space), 0.0).size(), 0);
  EXPECT_FALSE(linearize(job, space, elsewhere(space), 0.0).finite);
}

// The wrong mass makes the acceleration wrong by 3 m/s^2. The velocity is then wrong by that over
// the gain, 4 sigma at the highest gain here, and by half a metre per second in the free run.
TEST(ResidualsAt, AreSmallerTheMoreTheObserverTracks) {
  Job job = several_series();
  job.free[0].prior.reset();
  for (Recording& r : job.recordings) r.measurements[1].fitted = false;
  const ParameterSpace space(job);
  const auto size = [&](double gain) {
    return residuals_at(job, space, elsewhere(space), gain).norm();
  };
  EXPECT_LT(size(40.0), 0.5 * size(0.0));
  EXPECT_LT(size(400.0), 0.2 * size(40.0));
}

TEST(Solve, FindsTheTruthInExactReadings) {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  job.recordings = {recorded(slide(), fit_motion(), 1.2, 1, {Signal::velocity}, false)};
  const ParameterSpace space(job);
  const SolveResult solved = solve(job, space, elsewhere(space), 0.0, {});
  ASSERT_TRUE(solved.usable && solved.converged);
  const std::vector<double> values = space.values(solved.u);
  EXPECT_NEAR(values[0], slide().axis.M, 1e-6 * slide().axis.M);
  EXPECT_NEAR(values[1], slide().axis.B_a, 1e-6 * slide().axis.B_a);
}

TEST(Solve, ThrowsWhenItIsToStop) {
  const Job job = several_series();
  const ParameterSpace space(job);
  StopFlag stop;
  stop.set();
  EXPECT_THROW(solve(job, space, elsewhere(space), 0.0, {}, {.stop = &stop}), Interrupted);
}

}  // namespace
}  // namespace axisfit
