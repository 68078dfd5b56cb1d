#include "fit/data/job.h"

#include <gtest/gtest.h>

#include <cmath>

namespace axisfit {
namespace {

/// Samples `from` to `to` of one motion, 1 ms apart.
Recording recording_of(std::size_t from, std::size_t to) {
  Recording r;
  std::vector<double> times, values;
  for (std::size_t i = from; i < to; ++i) {
    times.push_back(1e-3 * static_cast<double>(i));
    values.push_back(std::sin(0.1 * static_cast<double>(i)));
  }
  r.times = times;
  Measurement& m = r.measurements.emplace_back();
  m.values = values;
  m.sigma = 0.1;
  return r;
}

void change(Recording& r, std::size_t sample, double value) {
  r.measurements[0].values.edit()[sample] = value;
}

TEST(ShareSamples, FindsARecordingThatIsGivenTwice) {
  EXPECT_TRUE(share_samples(recording_of(0, 100), recording_of(0, 100)));
  EXPECT_TRUE(share_samples(recording_of(0, 100), recording_of(90, 200))) << "partly";
  EXPECT_FALSE(share_samples(recording_of(0, 100), recording_of(100, 200))) << "two parts";
  EXPECT_FALSE(share_samples(recording_of(0, 100), recording_of(95, 200))) << "five by chance";
}

TEST(ShareSamples, AnotherRecordingAtTheSameTimesIsNotTheSame) {
  Recording other = recording_of(0, 100);
  change(other, 50, 0.0);
  EXPECT_FALSE(share_samples(recording_of(0, 100), other));
  Recording accelerometer = recording_of(0, 100);
  accelerometer.measurements[0].signal = Signal::acceleration;
  EXPECT_FALSE(share_samples(recording_of(0, 100), accelerometer)) << "no signal in common";
}

TEST(ShareSamples, TwoRecordingsOfAStandstillAreNotTheSame) {
  Recording a = recording_of(0, 100), b = a;
  for (std::size_t i = 0; i < 100; ++i) {
    change(a, i, 0.0);
    change(b, i, 0.0);
  }
  EXPECT_FALSE(share_samples(a, b));
}

/// A recording to fit and one to validate, and one free parameter.
Job two_roles() {
  Job job;
  job.recordings = {recording_of(0, 100), recording_of(100, 200)};
  job.recordings[0].held_out.assign(100, true);
  job.recordings[1].role = Role::validate;
  job.free = {free_parameter("M", 10.0)};
  return job;
}

TEST(ExchangedRoles, FitWhatValidatedAndTheOtherWayRound) {
  const auto exchanged = with_exchanged_roles(two_roles());
  ASSERT_TRUE(exchanged);
  EXPECT_EQ(exchanged->recordings[0].role, Role::validate);
  EXPECT_EQ(exchanged->recordings[1].role, Role::fit);
  EXPECT_TRUE(exchanged->recordings[0].held_out.empty());
}

TEST(ExchangedRoles, NeedParametersOfAllRecordings) {
  Job job = two_roles();
  job.recordings[1].role = Role::fit;
  EXPECT_FALSE(with_exchanged_roles(job)) << "nothing validates";
  job = two_roles();
  job.free[0].recording = 0;
  EXPECT_FALSE(with_exchanged_roles(job));
  job = two_roles();
  job.recordings[1].overrides = {{job.free[0].quantity, 12.0}};
  EXPECT_FALSE(with_exchanged_roles(job)) << "its mass is given";
  job.recordings[1].overrides = {{quantity_index("B_a"), 12.0}};
  EXPECT_TRUE(with_exchanged_roles(job));
}

}  // namespace
}  // namespace axisfit
