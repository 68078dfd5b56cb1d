#include "fit/criterion/gains.h"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(ObserverForRecording, TakesVelocityThenPosition) {
  Recording recording;
  EXPECT_FALSE(observer_for(recording, 100.0).active());
  const auto add = [&](Signal signal) { recording.measurements.emplace_back().signal = signal; };
  add(Signal::position);
  EXPECT_EQ(observer_for(recording, 100.0).acceleration, 1e4);
  add(Signal::velocity);
  EXPECT_EQ(observer_for(recording, 100.0).velocity, 100.0);
  EXPECT_EQ(observer_for(recording, 100.0).position, 100.0);
  EXPECT_FALSE(observer_for(recording, 0.0).active());
}

TEST(Gains, BeginAsHighAsTheSamplingAllows) {
  Job job = sampled({2e-3}, Signal::velocity);
  EXPECT_NEAR(highest_gain(job), 500.0, 1e-9);
  job.recordings[0].measurements.emplace_back().signal = Signal::position;
  EXPECT_NEAR(highest_gain(job), 500.0, 1e-9);
  EXPECT_NEAR(highest_gain(sampled({2e-3}, Signal::position)), 150.0, 1e-9);
}

TEST(Gains, BeginWhereTheJobSays) {
  Job job = sampled({2e-3}, Signal::velocity);
  job.options.continuation = Continuation{70.0};
  EXPECT_EQ(highest_gain(job), 70.0);
  job.options.criterion = Windows{0.1};
  EXPECT_EQ(highest_gain(job), 70.0);
  job.options.criterion = Tracking{40.0};
  EXPECT_EQ(highest_gain(job), 40.0);
  job.options.criterion = Tracking{};  // which takes no continuation
  EXPECT_NEAR(highest_gain(job), 500.0, 1e-9);
}

TEST(Gains, BeginWhereTheCoarsestRecordingToBeFittedAllows) {
  Job job = sampled({2e-3, 4e-3, 8e-3}, Signal::velocity);
  job.recordings[2].role = Role::validate;
  EXPECT_NEAR(highest_gain(job), 250.0, 1e-9);
}

TEST(Gains, EndAtZeroUnlessTheFitTracks) {
  Job job = sampled({2e-3}, Signal::velocity);
  EXPECT_EQ(final_gain(job), 0.0);
  job.options.criterion = Windows{0.1};
  EXPECT_EQ(final_gain(job), 0.0);
  job.options.continuation.reset();
  EXPECT_EQ(final_gain(job), 0.0);
  job.options.criterion = Tracking{};
  EXPECT_NEAR(final_gain(job), 500.0, 1e-9);
  job.options.criterion = Tracking{30.0};
  EXPECT_EQ(final_gain(job), 30.0);
}

TEST(Gains, AreScoredFarBelowTheHighestUnlessOneIsGiven) {
  Job job = sampled({2e-3}, Signal::velocity);
  ASSERT_EQ(score_gains(job).size(), 3u);
  EXPECT_NEAR(score_gains(job)[0], 50.0, 1e-9);
  EXPECT_NEAR(score_gains(job)[1], 500.0 / 30.0, 1e-9);
  EXPECT_NEAR(score_gains(job)[2], 5.0, 1e-9);
  EXPECT_EQ(search_gain(job), score_gains(job)[1]);
  job.options.criterion = Tracking{30.0};
  EXPECT_EQ(score_gains(job), std::vector{30.0});
  job.choose_criterion = true;  // nobody gave it
  EXPECT_EQ(score_gains(job), (std::vector{3.0, 1.0, 0.3}));
}

TEST(Gains, NeedAPositionOrAVelocityToBeFitted) {
  Job job = sampled({2e-3, 2e-3}, Signal::velocity);
  EXPECT_TRUE(can_track(job));
  job.recordings[0].measurements[0].signal = Signal::acceleration;
  EXPECT_TRUE(can_track(job));
  job.recordings[1].role = Role::validate;
  EXPECT_FALSE(can_track(job));
  EXPECT_TRUE(std::isinf(highest_gain(job)));
  EXPECT_FALSE(has_choice_of_gains(job));
}

TEST(Gains, TakeWhatIsTrackedToBeInTime) {
  const auto ignored = [](const char* name, const Criterion& criterion) {
    return is_ignored(quantity_list()[quantity_index(name)], criterion);
  };
  for (const char* late : {"velocity.delay", "velocity.lag", "position.delay"}) {
    EXPECT_TRUE(ignored(late, Tracking{}));
    EXPECT_FALSE(ignored(late, FreeRun{}));
    EXPECT_FALSE(ignored(late, Windows{1.0}));
  }
  EXPECT_FALSE(ignored("acceleration.delay", Tracking{}));
  EXPECT_FALSE(ignored("velocity.gain", Tracking{}));
}

}  // namespace
}  // namespace axisfit
