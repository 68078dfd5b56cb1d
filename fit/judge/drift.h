// The drift of a residual, as of an instrument that warms up or a gear that runs in.
#pragma once

#include <cmath>
#include <span>

namespace axisfit {

struct Drift {
  double per_second = 0.0;           ///< in the unit of the values
  double standard_error = INFINITY;  ///< of that
  double p_value = 1.0;              ///< of that trend or more, either way, were there none
  double span = 0.0;                 ///< of the trend, from the first time to the last

  /// Of residuals in units of the noise: significant, and a tenth of the noise or more.
  bool is_notable() const { return p_value < 1e-3 && (span > 0.1 || span < -0.1); }
};

/// The linear trend of a residual series, by least squares. Its standard error allows for the
/// colour of what is left when the trend is taken off, as those of parameters do (uncertainty.h).
/// The p-value is Student's, with one independent sample for each autocorrelation time; with fewer
/// than some fifteen of them it errs to the small side, and so it does where slow noise hides
/// beneath as much white noise.
///
/// This is what a drift would be, not evidence of one: a step, a bend and a slow wave of less than
/// a period have a significant trend too.
///
/// Times, one for each value, increase, if not evenly; noise is taken to be correlated from sample
/// to sample, whatever the time between them. With fewer than three values, or too few independent
/// ones, the standard error stays infinite and p one.
Drift drift(std::span<const double> times, std::span<const double> values);

}  // namespace axisfit
