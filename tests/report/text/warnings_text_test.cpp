#include <gtest/gtest.h>

#include "report/text/report_text.h"

namespace axisfit {
namespace {

std::string text_of(const RecordingWarning& warning) {
  return warning_text(warning, kSourceVocabulary);
}

std::string of_rate(Signal rate, double ratio, std::optional<UnitMistake> mistake) {
  const Signal of = rate == Signal::velocity ? Signal::position : Signal::velocity;
  return text_of(warning::WrongRate{{rate, of, {ratio, 1.0}}, mistake.has_value(), mistake});
}

TEST(WarningsTextTest, OfTheSampling) {
  EXPECT_EQ(text_of(warning::Gaps{1, 0.5, 3.25}),
            "A gap of 0.5 s at 3.25 s. The command is unknown there: trim the recording, or split "
            "it in two.");
  EXPECT_EQ(text_of(warning::Gaps{3, 0.5, 3.25}),
            "3 gaps, the largest of 0.5 s at 3.25 s. The command is unknown there: trim the "
            "recording, or split it in two.");
  EXPECT_EQ(text_of(warning::UnevenSampling{0.123}),
            "Sampling is uneven, with a jitter of 12 %. If the clock is even and only the time "
            "stamps are not, use sample numbers instead; otherwise give every sigma, because its "
            "estimate needs even sampling.");
  EXPECT_EQ(text_of(warning::UnlikelyInterval{0.25}),
            "Samples are 0.25 s apart. Is the unit of time right? For milliseconds use 'unit: ms', "
            "for microseconds 'unit: us'.");
  using enum warning::TimeUnit::Stored;
  const std::string time =
      "velocity and acceleration are both 1000 times the derivative: the unit of time is wrong. ";
  EXPECT_EQ(text_of(warning::TimeUnit{1000.0, milliseconds}), time + "Use 'unit: ms'.");
  EXPECT_EQ(text_of(warning::TimeUnit{1000.0, seconds}), time + "Use 'unit: s'.");
  EXPECT_EQ(text_of(warning::TimeUnit{1000.0, unknown}), time + "Correct it.");
}

TEST(WarningsTextTest, OfRates) {
  EXPECT_EQ(of_rate(Signal::velocity, -1.0, {}),
            "velocity is -1 times the derivative of the position. Their signs differ: use 'sign: "
            "-1' for one of them.");
  EXPECT_EQ(of_rate(Signal::velocity, 60.0, UnitMistake::minute),
            "velocity is 60 times the derivative of the position. The velocity is per minute: use "
            "m/min instead of m/s.");
  EXPECT_EQ(of_rate(Signal::acceleration, 60.0, UnitMistake::minute),
            "acceleration is 60 times the derivative of the velocity. The velocity is per second: "
            "use m/s instead of m/min.");
  EXPECT_EQ(of_rate(Signal::acceleration, -0.10197, UnitMistake::standard_gravity),
            "acceleration is -0.10197 times the derivative of the velocity. It is in g: use 'unit: "
            "m/s^2, factor: 9.80665'. Their signs differ: use 'sign: -1' for one of them.");
  warning::WrongRate rate{{Signal::velocity, Signal::position, {3.0, 1.0}}, true, {}};
  EXPECT_EQ(text_of(rate),
            "velocity is 3 times the derivative of the position. No unit explains this: is there a "
            "gear between the two?");
}

TEST(WarningsTextTest, OfSignals) {
  EXPECT_EQ(text_of(warning::NoCommand()),
            "The command is zero throughout: is that the right column?");
  EXPECT_EQ(text_of(warning::NoDirection{true}),
            "The command is never negative, but the arm goes both ways, as if driven by it in "
            "either direction: the column has the size of the command, and its direction is in "
            "another one. Multiply the two into one column.");
  EXPECT_EQ(text_of(warning::RepeatedInput{4}),
            "The command: each value is recorded 4 times. If the drive did not take it as such a "
            "staircase, record it at every sample, or keep only the rows with a new value.");
  EXPECT_EQ(
      text_of(warning::ClippedInput{30, 8.0}),
      "The size of the command is exactly 8 V in 30 samples, and noisy elsewhere: its sensor is "
      "at the end of its range, and the force beyond is not recorded. Record with a wider range, "
      "or "
      "what the drive was told.");
  EXPECT_EQ(text_of(warning::OnHardStop{{1.2345, 1.2325}}),
            "The arm runs into a hard stop at 1.2345 s and stays there to the end, while the drive "
            "still pushes. The model has no such stop: exclude it with 'trim: {to: 1.2325 s}'.");
  EXPECT_EQ(text_of(warning::UnlikelySpeed{0.5, 10.0, 50.0, Signal::position}),
            "The arm reaches 0.5 m/s, but at its largest command, 10 V, the axis file gives 50 "
            "m/s. Check the units of the command and of the position, and K_1, K_2, K_t and r_g.");
  EXPECT_EQ(text_of(warning::Constant{Signal::tachometer}),
            "tachometer is constant: is that the right column?");
  EXPECT_EQ(text_of(warning::Stuck{Signal::velocity, 40, 1.5}),
            "velocity has the same value in 40 samples from 1.5 s on, while the arm moves: the "
            "sensor is stuck. Trim the recording, or do not fit the signal ('fit: false').");
  EXPECT_EQ(
      text_of(warning::Jumped{Signal::position, -0.002, 1.25}),
      "position jumps by -0.002 m at 1.25 s, and goes on from there: counts or rows are lost, "
      "or its zero was set. Split the recording there, or exclude what is before or behind "
      "with 'trim'.");
  EXPECT_EQ(text_of(warning::Clipped{Signal::acceleration, 7, 20.0}),
            "acceleration is exactly 20 m/s^2 in 7 samples: it is clipped at the end of its range. "
            "Record with a wider range, or do not fit the signal ('fit: false').");
  EXPECT_EQ(
      text_of(warning::Missing{Signal::position, 3, 400}),
      "position has no value in 3 of 400 samples, which are left out; if it was recorded more "
      "slowly than the rest, that is as it should be.");
  EXPECT_EQ(text_of(warning::Repeated{Signal::position, 10}),
            "position: each value is recorded 10 times, by a sample and hold. Set 'hold: 10'.");
  EXPECT_EQ(text_of(warning::Filtered{Signal::velocity, 21.0, 21}),
            "velocity is a moving average of 21 samples: the fit takes that for a part of the "
            "axis. Set 'filter: {moving_average: 21}', with 'zero_phase: true' if each is the mean "
            "of the samples about it, or record it unfiltered.");
  EXPECT_EQ(text_of(warning::Filtered{Signal::velocity, 62.5, 0}),
            "velocity hardly has noise above about 60 Hz: it went through a low-pass filter, which "
            "the fit takes for a part of the axis. Set 'filter' as the drive or recorder has it, "
            "or record it unfiltered.");
  EXPECT_EQ(text_of(warning::UnlikelySigma{Signal::velocity, 0.001, 2e-5}),
            "velocity scatters by 0.001 m/s from sample to sample, but its sigma is 2e-05 m/s. "
            "Without a sigma the scatter is used.");
}

}  // namespace
}  // namespace axisfit
