// The thresholds in what is reported of errors.
#pragma once

#include <cstddef>
#include <numbers>

namespace axisfit {

/// Lengths "on the scale of a parameter" are e-folds of a logarithmic one, and half of the range
/// that its bounds allow of a linear one.
struct ErrorOptions {
  /// Distance from a bound, relative to the estimate's size on its scale, at which an estimate
  /// counts as at the bound. The solver leaves no more.
  double at_bound = 1e-6;
  /// Part of a combination without effect that leaves a parameter open. Smaller ones come from
  /// rounding.
  double open_part = 0.1;
  /// An interval as wide as the allowed range carries no information, nor does an error from zero
  /// as large as the value ...
  double largest_error = 1.0;
  /// ... nor, on a logarithmic scale, one that twice to either side spans a decade: not even the
  /// order of magnitude is known.
  double largest_log_error = 0.25 * std::numbers::ln10;
  /// On the scale of a parameter: a larger error tells no more than the order of magnitude.
  double weak_error = 0.25;
  /// Correlation beyond which two estimates are hardly determined apart: their errors are three
  /// times what either has with the other known.
  double strong_correlation = 0.95;
  /// Autocorrelation time in samples up to which residuals count as white: errors are a tenth
  /// larger there.
  double white_time = 1.2;
  /// Part of the residual's sum of squares that the estimates leave at least. Where hardly anything
  /// is left, nobody knows how much there was.
  double least_left = 0.1;

  /// A weak direction is described by the parameters with this part of its largest component or
  /// more.
  double told_part = 0.1;

  /// A guess is changed by this part ...
  double guess_change = 0.1;
  /// ... and an estimate rests on it that moves by more than this part of its value, or more than
  /// its standard error.
  double guess_move = 0.01;

  /// Sum of squares, in variances, by which one hold of the input leaves more than the other where
  /// the recordings tell them apart: four standard deviations.
  double excluded_cost = 16.0;

  /// Other observer gains are higher and lower by this factor: enough for the weights of slow and
  /// fast residuals to differ clearly.
  double other_gain = 3.0;
  /// Standard errors, of both fits together, that a move at another gain must exceed: less is
  /// chance in 19 of 20.
  double gain_errors = 2.0;
  /// Another gain is named if it leaves no more than this part of the free-running error.
  double better_gain = 0.8;

  /// Standard errors that a move with a rival must exceed. There is no chance in it, for both
  /// models are fitted to the same recordings.
  double rival_errors = 1.0;

  /// Significance of the likelihood ratio at which scatter counts. Scatter that is missed costs
  /// coverage; chance that is counted as scatter widens intervals a little
  /// (bench/results/scatter.md).
  double scatter_significance = 0.2;
  /// Fall of the log-likelihood at the ends of a 95 % interval: half of chi-square's
  /// quantile, 3.84.
  double interval_fall = 1.92;
  /// Standard deviation, on the scale of u, of a parameter that one group leaves open: far more
  /// than that of any that is determined.
  double open_deviation = 10.0;
  /// A stretch of the only recording has so many samples, for its colour to be known ...
  std::ptrdiff_t stretch_rows = 400;
  /// ... and there are no more than so many: enough for a variance, and each as long as can be.
  std::ptrdiff_t most_stretches = 6;
};

}  // namespace axisfit
