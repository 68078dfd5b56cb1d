// Options of fits that are only compared with others.
#pragma once

#include "fit/data/job.h"

namespace axisfit {

/// Options for a fit that starts close by and serves comparison: one start, one continuation, the
/// minimum to a small part of the standard errors, and these to within a quarter.
inline FitOptions quick_fit(FitOptions options) {
  options.starts = 1;
  options.attempts = 1;
  options.tolerance = 1e-6;
  options.input_noise_draws = 8;
  options.step *= 2.0;  // smooth effects are then a few parts in a hundred thousand off
  return options;
}

}  // namespace axisfit
