// The numbers that decide how a fit is judged: each has a name, a reason, and this one place.
#pragma once

#include <cstddef>

namespace axisfit {

/// Isolated bad samples (outliers.h).
struct OutlierOptions {
  std::size_t fewest_samples = 30;  ///< of a series, for it to have a scale
  std::size_t neighbours = 10;      ///< on either side, whose median is the level
  std::size_t phase = 50;           ///< samples over which the scatter is one and the same
  std::size_t burst = 3;            ///< bad samples in a row, at most
  double alone = 1.0 / 3.0;         ///< of its deviation, within which its neighbours stay
  double false_alarms = 0.005;      ///< in a series of Gaussian noise
  /// The scale is not taken at the median of the magnitudes but where this part of them is less:
  /// nearly twice as efficient, it sees a phase of motion that is a fifth of a series, and the
  /// values of a grid most of which are equal. That fewer than one in five are bad may be assumed.
  double scale_part = 0.8;
};

/// What docs/effect-selection.md and docs/result.md say of explained signals and of grades holds
/// with these values.
struct GradeOptions {
  // Whether a signal is explained: whether its mean square is that of its noise.
  double excess = 0.05;  ///< over one, that matters to nobody however many the samples are
  double errors = 4.0;   ///< standard errors of the mean square of white noise, that count as one
  /// Standard error of the mean square times the root of the samples, where the noise was estimated
  /// from differences of as many samples: both scatter (by simulation). Root of two where it is
  /// given.
  double spread_of_estimated_noise = 3.2;
  /// The same of the autocorrelation time, where the size of the noise is that of the residual.
  double colour_excess = 0.25, colour_errors = 8.0;

  // Whether a residual depends on a variable that it should not depend on.
  std::size_t ranges = 12;     ///< of the variable, with equally many samples
  double significance = 1e-3;  ///< of eight variables and dozens of signals, one by chance is rare
  OutlierOptions outliers{};
  double outlier_sigmas = 4.0;  ///< less stands out from its neighbours alone, as a count does

  // How far a fit can be relied on.
  /// Of a signal that a usable simulation follows, per cent: half is what a model must do to be
  /// one.
  double least_followed = 50.0;
  double noisy_chi_square = 2.0;  ///< a signal hardly larger than its noise proves nothing
  /// Per cent of the drive force that may be missing of a model that describes the machine, and of
  /// one whose free run drifts: there it must be small all the more.
  double largest_force = 50.0, small_force = 10.0;
  /// A recording is tried as one of another day (other_day.h) where its missing force is more than
  /// this many times that of those fitted, or than a force that is noticed at all, per cent.
  double other_day_factor = 2.0, noticed_force = 1.0;
  /// Of the allowed range, the interval of a parameter at its bound that says anything of it.
  double informed_part = 0.25;

  // The balance of forces beside a fit (second_opinion.h).
  double useful_residual = 0.7;  ///< of the drive force: a balance that leaves more is no start
  double same_minimum = 0.999;   ///< ratio of costs, above which two minima are one
  double contradiction_errors = 5.0, contradiction_part = 0.1;  ///< by which both must differ
};

}  // namespace axisfit
