// What looks wrong with a recording by itself, and with its units.
#pragma once

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "fit/data/recording_check.h"

namespace axisfit {

/// A unit taken for another.
enum class UnitMistake {
  milli,             ///< mm for m
  micro,             ///< um for m
  minute,            ///< a velocity per minute for one per second
  milli_per_minute,  ///< mm/min for m/s
  rpm,               ///< rpm for rad/s
  degrees,           ///< degrees for radians
  standard_gravity,  ///< g for m/s^2
};

namespace warning {

/// Stretches without samples, over which the command is unknown.
struct Gaps {
  std::size_t count = 0;
  double largest = 0.0, at = 0.0;  ///< s, and where that begins
};

struct UnevenSampling {
  double jitter = 0.0;  ///< as Sampling::jitter
};

/// Every rate is wrong by the same factor.
struct TimeUnit {
  enum class Stored { milliseconds, seconds, unknown };
  double ratio = 1.0;               ///< of a recorded rate and the derivative, magnitude
  Stored stored = Stored::unknown;  ///< the unit that would explain it
};

/// Intervals that no axis is likely to be sampled at.
struct UnlikelyInterval {
  double interval = 0.0;  ///< s
};

/// A rate that is not the derivative of the other signal, by its size or its sign.
struct WrongRate {
  RateCheck rate;
  bool wrong_size = false;               ///< false: only the sign
  std::optional<UnitMistake> mistake{};  ///< that would explain the size; none: none of those known
};

struct NoCommand {};

/// A command whose sign is elsewhere: it never changes, and the arm goes both ways.
struct NoDirection {
  bool is_positive = true;  ///< whether it is never negative; false: never positive
};

/// Each value of the input is recorded several times, and is no staircase that acted so.
struct RepeatedInput {
  std::size_t times = 1;
};

/// The sensor of a measured input is at the end of its range: the force beyond is not recorded.
struct ClippedInput {
  std::size_t samples = 0;
  double value = 0.0;  ///< magnitude, in the unit of the drive
};

/// A motion that ends on a hard stop, which the model does not have.
struct OnHardStop {
  HardStop stop;
};

/// The axis file gives another speed at the largest command than the arm reaches.
struct UnlikelySpeed {
  double speed = 0.0;              ///< m/s, of the arm
  double command = 0.0;            ///< V, magnitude
  double expected = 0.0;           ///< m/s, at that command
  Signal from = Signal::velocity;  ///< the signal that gives the speed
};

struct Constant {
  Signal signal = Signal::velocity;
};

/// A sensor that repeats one value while the arm moves.
struct Stuck {
  Signal signal = Signal::velocity;
  std::size_t samples = 0;
  double at = 0.0;  ///< s, where that begins
};

/// A sensor at the end of its range.
struct Clipped {
  Signal signal = Signal::velocity;
  std::size_t samples = 0;
  double value = 0.0;  ///< in the signal's unit
};

/// A position that goes on displaced.
struct Jumped {
  Signal signal = Signal::position;
  double size = 0.0;  ///< in the signal's unit
  double at = 0.0;    ///< s, of the first sample behind it
};

/// Some values are not in the recording: blank, or not a number.
struct Missing {
  Signal signal = Signal::velocity;
  std::size_t samples = 0, of = 0;  ///< missing, and all
};

/// Each value is recorded several times.
struct Repeated {
  Signal signal = Signal::velocity;
  std::size_t times = 1;
};

/// A low-pass filter that is not declared.
struct Filtered {
  Signal signal = Signal::velocity;
  double corner = 0.0;      ///< Hz, within a factor of two
  std::size_t average = 0;  ///< samples of a moving average; zero: another filter
};

/// The noise that is given is not that of the samples.
struct UnlikelySigma {
  Signal signal = Signal::velocity;
  double scatter = 0.0, sigma = 0.0;  ///< in the signal's unit
};

}  // namespace warning

using RecordingWarning =
    std::variant<warning::Gaps, warning::UnevenSampling, warning::TimeUnit,
                 warning::UnlikelyInterval, warning::WrongRate, warning::NoCommand,
                 warning::NoDirection, warning::RepeatedInput, warning::ClippedInput,
                 warning::OnHardStop, warning::UnlikelySpeed, warning::Constant, warning::Stuck,
                 warning::Clipped, warning::Jumped, warning::Missing, warning::Repeated,
                 warning::Filtered, warning::UnlikelySigma>;

/// Whether it tells of values that are not what happened, or happened to no axis: what no model
/// explains, and any may be bent to.
bool is_fault(const RecordingWarning& found);

/// In the order of the alternatives, those of a signal after those of the whole recording.
std::vector<RecordingWarning> warnings_of(const Job& job, const Recording& recording,
                                          const RecordingCheck& check);

}  // namespace axisfit
