#include "fit/data/recording_warnings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// A recording of which nothing looks wrong, and what its check found.
class RecordingWarningsTest : public testing::Test {
 protected:
  RecordingWarningsTest() {
    job_.model = slide();
    for (const Signal signal : {Signal::velocity, Signal::acceleration}) {
      Measurement& m = recording_.measurements.emplace_back();
      m.signal = signal;
      m.sigma = 0.01;
      m.noise = NoiseSource::given;
      check_.measurements.push_back({.low = -1.0, .high = 1.0, .noise = 0.01});
    }
    check_.sampling.interval = 1e-3;
    check_.command = {.low = -1.0, .high = 1.0};
    check_.rates = {{Signal::velocity, Signal::position, {1.0, 1.0}},
                    {Signal::acceleration, Signal::velocity, {1.0, 1.0}}};
  }
  std::vector<RecordingWarning> found() const { return warnings_of(job_, recording_, check_); }

  /// The only warning, which is of this kind.
  template <class Kind>
  Kind only() const {
    const std::vector<RecordingWarning> warnings = found();
    EXPECT_EQ(warnings.size(), 1u);
    if (warnings.size() == 1 && std::holds_alternative<Kind>(warnings[0]))
      return std::get<Kind>(warnings[0]);
    ADD_FAILURE() << "another kind";
    return {};
  }
  void set_ratios(double velocity, double acceleration) {
    check_.rates[0].found.ratio = velocity;
    check_.rates[1].found.ratio = acceleration;
  }

  Job job_;
  Recording recording_;
  RecordingCheck check_;
};

TEST_F(RecordingWarningsTest, AreNoneWhereNothingLooksWrong) {
  EXPECT_TRUE(found().empty());
  set_ratios(1.1, 0.9);  // as far as noise makes them wrong
  check_.sampling.jitter = 0.09;
  EXPECT_TRUE(found().empty());
}

TEST_F(RecordingWarningsTest, OfTheSampling) {
  check_.sampling.gaps = 2;
  check_.sampling.largest_gap = 0.5;
  check_.sampling.gap_at = 3.0;
  const auto gaps = only<warning::Gaps>();
  EXPECT_EQ(gaps.count, 2u);
  EXPECT_EQ(gaps.largest, 0.5);
  EXPECT_EQ(gaps.at, 3.0);
  check_.sampling = {.interval = 0.25};
  EXPECT_EQ(only<warning::UnlikelyInterval>().interval, 0.25);
  check_.sampling = {.interval = 1e-6};
  EXPECT_EQ(only<warning::UnlikelyInterval>().interval, 1e-6);
  check_.sampling = {.interval = 1e-3, .jitter = 0.11};
  EXPECT_EQ(only<warning::UnevenSampling>().jitter, 0.11);
}

TEST_F(RecordingWarningsTest, OfARateNameTheUnitThatExplainsIt) {
  const auto mistake = [&](double velocity, double acceleration) {
    set_ratios(velocity, acceleration);
    const auto wrong = only<warning::WrongRate>();
    EXPECT_TRUE(wrong.wrong_size);
    EXPECT_EQ(wrong.rate.rate, velocity == 1.0 ? Signal::acceleration : Signal::velocity);
    return wrong.mistake;
  };
  EXPECT_EQ(mistake(1050.0, 1.0), UnitMistake::milli);
  EXPECT_EQ(mistake(0.95e-3, 1.0), UnitMistake::milli);
  EXPECT_EQ(mistake(-1e6, 1.0), UnitMistake::micro);
  EXPECT_EQ(mistake(1.0 / 6e4, 1.0), UnitMistake::milli_per_minute);
  EXPECT_EQ(mistake(9.5493, 1.0), UnitMistake::rpm);
  EXPECT_EQ(mistake(1.0, 0.1019716), UnitMistake::standard_gravity);
  EXPECT_EQ(mistake(1.0, 60.0), UnitMistake::minute);
  EXPECT_EQ(mistake(3.0, 1.0), std::nullopt);
  set_ratios(-1.0, 1.0);
  const auto turned = only<warning::WrongRate>();
  EXPECT_FALSE(turned.wrong_size);
  EXPECT_EQ(turned.mistake, std::nullopt);
}

TEST_F(RecordingWarningsTest, OfAllRatesAlikeIsTheUnitOfTime) {
  using enum warning::TimeUnit::Stored;
  check_.sampling.interval = 1.0;  // not warned of in addition
  set_ratios(1000.0, 1050.0);
  EXPECT_EQ(only<warning::TimeUnit>().stored, milliseconds);
  EXPECT_EQ(only<warning::TimeUnit>().ratio, 1000.0);
  set_ratios(1e-3, -1e-3);
  EXPECT_EQ(only<warning::TimeUnit>().stored, seconds);
  set_ratios(60.0, 60.0);
  EXPECT_EQ(only<warning::TimeUnit>().stored, unknown);
  check_.sampling.interval = 1e-3;
  set_ratios(60.0, 1000.0);
  EXPECT_EQ(found().size(), 2u);
}

TEST_F(RecordingWarningsTest, OfTheCommand) {
  check_.command = {};
  only<warning::NoCommand>();
  check_.command = {.low = 0.0, .high = 2.0};
  check_.command_is_magnitude = true;
  EXPECT_TRUE(only<warning::NoDirection>().is_positive);
  check_.command = {.low = -2.0, .high = 0.0};
  EXPECT_FALSE(only<warning::NoDirection>().is_positive);
  check_.command_is_magnitude = false;
  check_.hard_stop = HardStop{1.5, 1.4};
  EXPECT_EQ(only<warning::OnHardStop>().stop.last_before, 1.4);
}

TEST_F(RecordingWarningsTest, OfAnInputAtTheEndOfItsRange) {
  check_.command.clipped = 30;
  check_.command.clipped_at = 1.2;
  EXPECT_EQ(only<warning::ClippedInput>().samples, 30u);
  EXPECT_EQ(only<warning::ClippedInput>().value, 1.2);
}

TEST_F(RecordingWarningsTest, OfAnInputThatIsRepeatedUnlessItActsSo) {
  check_.command.repetition = 4;
  EXPECT_TRUE(found().empty());
  recording_.command.hold = Hold::linear;
  EXPECT_EQ(only<warning::RepeatedInput>().times, 4u);
  recording_.command.hold = Hold::zero_order;
  check_.measurements[1].repetition = 4;
  EXPECT_EQ(found().size(), 2u);
}

TEST_F(RecordingWarningsTest, OfASpeedThatTheAxisFileDoesNotGive) {
  job_.model.structure.drive = Drive::velocity_loop;
  auto& axis = job_.model.axis;
  axis.K_1 = 2.0;
  axis.r_g = 0.05;
  axis.K_2 = 0.5;
  axis.K_t = 0.1;  // 2 m/s per volt
  check_.command = {.low = -3.0, .high = 1.0};
  for (const double speed : {0.21, 17.9}) {
    check_.speed = speed;
    EXPECT_TRUE(found().empty()) << speed;
  }
  for (const double speed : {0.19, 18.1}) {
    check_.speed = speed;
    const auto unlikely = only<warning::UnlikelySpeed>();
    EXPECT_EQ(unlikely.speed, speed);
    EXPECT_EQ(unlikely.command, 3.0);
    EXPECT_NEAR(unlikely.expected, 6.0, 1e-12);
    EXPECT_EQ(unlikely.from, Signal::velocity);
  }
  recording_.measurements[0].signal = Signal::position;
  EXPECT_EQ(only<warning::UnlikelySpeed>().from, Signal::position);
}

TEST_F(RecordingWarningsTest, OfASignal) {
  const ValueCheck usual = check_.measurements[1];
  ValueCheck& values = check_.measurements[1];
  values.low = values.high;
  EXPECT_EQ(only<warning::Constant>().signal, Signal::acceleration);
  values = usual;
  values.stuck = 40;
  values.stuck_at = 1.5;
  const auto stuck = only<warning::Stuck>();
  EXPECT_EQ(stuck.signal, Signal::acceleration);
  EXPECT_EQ(stuck.samples, 40u);
  EXPECT_EQ(stuck.at, 1.5);
  values = usual;
  values.clipped = 7;
  values.clipped_at = 20.0;
  const auto clipped = only<warning::Clipped>();
  EXPECT_EQ(clipped.signal, Signal::acceleration);
  EXPECT_EQ(clipped.samples, 7u);
  EXPECT_EQ(clipped.value, 20.0);
  values = usual;
  values.jump = -0.5;
  values.jump_at = 1.25;
  const auto jumped = only<warning::Jumped>();
  EXPECT_EQ(jumped.signal, Signal::acceleration);
  EXPECT_EQ(jumped.size, -0.5);
  EXPECT_EQ(jumped.at, 1.25);
  values = usual;
  values.repetition = 10;
  EXPECT_EQ(only<warning::Repeated>().signal, Signal::acceleration);
  EXPECT_EQ(only<warning::Repeated>().times, 10u);
}

TEST_F(RecordingWarningsTest, TellFaultsFromHabitsOfTheRecorder) {
  EXPECT_TRUE(is_fault(warning::Jumped()));
  EXPECT_TRUE(is_fault(warning::ClippedInput()));
  EXPECT_FALSE(is_fault(warning::Gaps()));
  EXPECT_FALSE(is_fault(warning::Repeated()));
}

TEST_F(RecordingWarningsTest, OfAFilterWhereTheSamplingIsEven) {
  check_.measurements[0].filter = SuspectedFilter{0.05, 8};
  const auto filtered = only<warning::Filtered>();
  EXPECT_EQ(filtered.signal, Signal::velocity);
  EXPECT_DOUBLE_EQ(filtered.corner, 50.0);
  EXPECT_EQ(filtered.average, 8u);
  check_.sampling.jitter = 0.2;
  EXPECT_EQ(only<warning::UnevenSampling>().jitter, 0.2);
}

TEST_F(RecordingWarningsTest, OfASigmaThatIsNotTheScatter) {
  for (const double noise : {0.0011, 0.029, 0.0}) {
    check_.measurements[0].noise = noise;
    EXPECT_TRUE(found().empty()) << noise;
  }
  for (const double noise : {0.0009, 0.031}) {
    check_.measurements[0].noise = noise;
    const auto unlikely = only<warning::UnlikelySigma>();
    EXPECT_EQ(unlikely.signal, Signal::velocity);
    EXPECT_EQ(unlikely.scatter, noise);
    EXPECT_EQ(unlikely.sigma, 0.01);
  }
  recording_.measurements[0].noise = NoiseSource::differences;
  EXPECT_TRUE(found().empty());
}

}  // namespace
}  // namespace axisfit
