// Whether a signal stays at one value because its sensor does.
#pragma once

#include <cstddef>
#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// Samples at one value, [from, to).
struct EqualValues {
  std::size_t from = 0, to = 0;

  std::size_t size() const { return to - from; }
};

/// Samples at the end of a range.
struct ClippedValues {
  std::size_t samples = 0;  ///< zero: none
  double value = 0.0;       ///< that end, in the signal's unit
};

/// Tells what stays because a sensor hangs or is at the end of its range from what stays by itself:
/// an arm at rest, however short, rounding, and a drive that is told one value.
class StuckCheck {
 public:
  /// `standstill` is that of the recording (standstill.h). Both must outlive the check.
  StuckCheck(const Recording& recording, const std::vector<bool>& standstill);

  /// The longest run of at least 25 equal values that nothing else explains; of size zero where
  /// there is none.
  EqualValues stuck(const Measurement& measurement) const;

  /// The end of the range, of the two, at which more samples are than anything else explains, and
  /// at least 25.
  ClippedValues clipped(const Measurement& measurement) const;

 private:
  struct Values;

  bool is_moving(std::size_t sample) const { return standstill_.empty() || !standstill_[sample]; }
  bool rests(const Values& values, const EqualValues& run) const;
  bool is_commanded(const EqualValues& run) const;
  bool is_pushed(const Values& values, const EqualValues& run) const;
  bool agrees_with_position(const Values& values, const EqualValues& run) const;
  bool is_explained(const Values& values, const EqualValues& run) const;
  Values values_of(const Measurement& measurement) const;
  std::size_t clipped_at(const Values& values, double limit, double other) const;

  const Recording& recording_;
  const std::vector<bool>& standstill_;
  const Measurement *position_, *velocity_;
  double position_step_ = 0.0;   ///< that the position may show at rest, m
  double velocity_limit_ = 0.0;  ///< below which the velocity shows a rest, m/s
  std::vector<double> command_;  ///< in force at every sample
  double command_step_ = 0.0;    ///< beyond which it changes and is not noisy
  double command_range_ = 0.0;   ///< from the lowest to the highest
};

/// The command in force at every sample.
std::vector<double> sampled_command(const Recording& recording);

}  // namespace axisfit
