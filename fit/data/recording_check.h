// Checks of a recording without a model: its sampling, the ranges of its signals, and whether they
// are consistent.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fit/data/filter_check.h"
#include "fit/data/job.h"
#include "fit/data/motion_check.h"

namespace axisfit {

/// The intervals between the samples of a recording.
struct Sampling {
  std::size_t samples = 0;
  double duration = 0.0;  ///< s
  double interval = 0.0;  ///< s, the median
  double jitter = 0.0;    ///< standard deviation of the intervals that are no gaps, over the median
  std::size_t gaps = 0;   ///< intervals of more than 1.5 medians
  double largest_gap = 0.0;  ///< s, zero without gaps
  double gap_at = 0.0;       ///< s, recorded time where the largest one begins

  /// Whether the sampling is even enough for whatever goes from sample to sample.
  bool is_even() const { return jitter <= 0.1; }
};
Sampling sampling(std::span<const double> times);

/// What the values of a signal look like, in its unit.
struct ValueCheck {
  double low = 0.0, high = 0.0;
  double noise = 0.0;       ///< white part, from differences (noise.h)
  double resolution = 0.0;  ///< step between the values; zero: none
  /// The longest run of equal values that neither standstill nor rounding explains: a stuck sensor.
  /// Zero samples where there is none.
  std::size_t stuck = 0;
  double stuck_at = 0.0;  ///< s, where it begins
  /// Samples at exactly the lowest or the highest value while the arm moves, more than noise would
  /// ever put there: a range that the signal left. Zero where there are none.
  std::size_t clipped = 0;
  double clipped_at = 0.0;  ///< that value
  /// By how much a position jumps, and goes on from there; zero: it does not.
  double jump = 0.0;
  double jump_at = 0.0;  ///< s, of the first sample behind it
  /// How often each value is recorded, and a filter that the samples show; 1 and none where a hold
  /// or a filter is declared.
  std::size_t repetition = 1;
  std::optional<SuspectedFilter> filter{};
};

/// Largest logarithm of the ratio of two sizes that count as having one unit: noise in a measured
/// size causes less.
inline constexpr double kSameUnit = 0.14;

/// How a recorded rate compares with the rate of change of another signal.
struct RateRatio {
  double ratio = 0.0;        ///< rate = ratio * d(values)/dt
  double correlation = 0.0;  ///< between the changes in the two, -1 to 1

  /// Whether the one is the rate of the other at all, whatever the factor. Then noise makes the
  /// ratio wrong by no more than some 10 %.
  bool related() const { return correlation > 0.9 || correlation < -0.9; }
};

/// Compares the changes of `values` over stretches of the recording with the integral of `rate`
/// over them, so that noise and rounding of single samples do not count; in stretches of the length
/// at which the two agree best. A constant bias of the rate does no harm. Nothing where either does
/// not change.
std::optional<RateRatio> rate_ratio(std::span<const double> times, std::span<const double> values,
                                    std::span<const double> rate);

/// A fixed observer gain (job.h): 1/s to the velocity, or where that is empty rad/s to the
/// position.
struct SuggestedGain {
  double rate = 0.0;
  bool is_of_noise = false;  ///< the bandwidth of a Kalman filter; else missing physics shows
};

/// A gain at which missing physics shows: a hundredth of the usual acceleration of the axis then
/// moves the simulation by ten times the noise. A higher gain hides more and feeds the noise into
/// the simulation; a lower one lets it drift. Below the bandwidth of a Kalman filter the command's
/// noise adds up in the simulation and hides what is missing: the gain is no lower.
///
/// `command` is the force that drives the axis, in any unit, one value per sample, and `mass` that
/// of the axis, of that unit per m/s^2; zero where it is not known. The higher the gain, the more
/// the command's noise biases the estimates (a mass upwards): in standard errors, by the ratio of
/// noise to signal, times the gain, times the root of interval and duration. The gain keeps that
/// below a quarter, unless the noise is below 3 % of the signal: no gain then biases an estimate by
/// more than the square of that, a thousandth.
SuggestedGain suggested_observer_gain(std::span<const double> times,
                                      std::span<const double> position,
                                      std::span<const double> velocity,
                                      std::span<const double> command, double mass);

/// Two signals of a recording of which one is the rate of the other.
struct RateCheck {
  Signal rate = Signal::velocity, of = Signal::position;
  RateRatio found;
};

struct RecordingCheck {
  Sampling sampling;
  /// Of its values: low, high, repetition, and of what was measured, clipped, either way.
  ValueCheck command;
  std::size_t switches = 0;              ///< changes of the command
  double at_maximum = 0.0;               ///< share of the time the command is at its largest size
  bool command_is_magnitude = false;     ///< see is_magnitude()
  std::optional<HardStop> hard_stop{};   ///< where the motion ends on one
  std::vector<ValueCheck> measurements;  ///< in the recording's order
  std::vector<RateCheck> rates;          ///< those that are related
  double speed = 0.0;                    ///< m/s, largest, either way; zero where none is recorded
};

RecordingCheck check_recording(const Recording& recording);

/// Checks every recording of a job, in its order.
std::vector<RecordingCheck> check_recordings(const Job& job);

}  // namespace axisfit
