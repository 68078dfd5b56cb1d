#include "fit/estimate/free_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fit/data/noise.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

constexpr double kWhole = 100.0;  // s, more than any recording

/// A slide in 1.2 s, by its velocity and acceleration.
const Job& slide_job() {
  static const Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  return job;
}

const std::vector<double>& truth() {
  static const std::vector values{slide().axis.M, slide().axis.B_a};
  return values;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// What the noise alone makes: the mean over the signals of its share of their variance.
double noise_of(const Recording& recording) {
  std::vector<double> shares;
  for (const Measurement& m : recording.measurements)
    shares.push_back(std::pow(m.sigma / standard_deviation(m.values), 2));
  return mean(shares);
}

TEST(FreeRunErrors, OfTheTrueModelAreTheNoiseWhateverTheHorizon) {
  const double noise = noise_of(slide_job().recordings[1]);
  for (const double horizon : {0.1, 0.4, kWhole}) {
    const std::vector<double> errors = free_run_errors(slide_job(), truth(), 1, horizon);
    EXPECT_EQ(errors.size(), horizon == 0.1 ? 12u : horizon == 0.4 ? 3u : 1u);
    // Of 1201 squares of each signal the mean has a standard deviation of 4 %; where twenty samples
    // tell the state in which a window begins, that adds a twentieth.
    EXPECT_NEAR(mean(errors), noise, 0.16 * noise) << horizon;
  }
}

// As long as the motion goes one way: a force that is wrong makes a velocity whose error is in
// proportion to the time, and its square fourfold over twice that.
TEST(FreeRunErrors, OfAWrongModelAddUpOverTheHorizon) {
  Job job = slide_job();
  job.recordings[1].measurements.pop_back();
  const std::vector<double> wrong{truth()[0], 3.0 * truth()[1]};
  const auto error = [&](double horizon) { return mean(free_run_errors(job, wrong, 1, horizon)); };
  EXPECT_GT(error(0.1), 2.0 * error(0.05));
  EXPECT_GT(error(0.2), 2.0 * error(0.1));
}

// The first window begins with the model's state, unless the data are to say it; all others with
// their own.
TEST(FreeRunErrors, AWrongInitialStateIsOfTheFirstWindowAlone) {
  Job job = slide_job();
  job.model.initial[1] = 0.3;
  const double noise = noise_of(job.recordings[1]);
  const std::vector<double> given = free_run_errors(job, truth(), 1, 0.2);
  ASSERT_EQ(given.size(), 6u);
  EXPECT_GT(given[0], 100.0 * noise);
  for (std::size_t k = 1; k < given.size(); ++k) EXPECT_LT(given[k], 2.0 * noise) << k;
  job.recordings[1].initial_state = InitialState::data;
  EXPECT_LT(free_run_errors(job, truth(), 1, 0.2)[0], 2.0 * noise);
}

TEST(FreeRunErrors, AreOfTheFittedSignalsAlone) {
  Job job = slide_job();
  std::vector<Measurement>& measurements = job.recordings[1].measurements;
  measurements[1].fitted = false;
  const std::vector<double> velocity = free_run_errors(job, truth(), 1, kWhole);
  measurements.pop_back();
  EXPECT_EQ(free_run_errors(job, truth(), 1, kWhole), velocity);
}

TEST(FreeRunErrors, OfAWindowWithoutSamplesThatCountAreNotANumber) {
  Job job = slide_job();
  for (Measurement& m : job.recordings[1].measurements) {
    m.excluded.assign(m.values.size(), false);
    std::fill_n(m.excluded.begin() + 400, 200, true);  // the third, and no less
  }
  const std::vector<double> errors = free_run_errors(job, truth(), 1, 0.2);
  ASSERT_EQ(errors.size(), 6u);
  for (std::size_t k = 0; k < errors.size(); ++k) EXPECT_EQ(std::isnan(errors[k]), k == 2) << k;
}

TEST(FreeRunErrors, AreNoneWhereTheRunDoesNotFinish) {
  for (const double horizon : {0.1, kWhole})
    EXPECT_TRUE(free_run_errors(slide_job(), {{std::nan(""), 30.0}}, 1, horizon).empty());
}

}  // namespace
}  // namespace axisfit
