// How the fits that follow the first one differ from it: named options, each with its reason. All
// keep the criterion.
#pragma once

#include <algorithm>

#include "fit/criterion/gains.h"
#include "fit/data/job.h"

namespace axisfit::recipe {

/// For a fit that begins near its minimum and finds it at once: one start, one continuation.
inline FitOptions once(FitOptions options) {
  options.starts = 1;
  options.attempts = 1;
  return options;
}

/// For a fit that begins at a minimum, or close by, and must not leave it: no continuation, which
/// could.
inline FitOptions polish(FitOptions options) {
  options.starts = 1;
  options.continuation.reset();
  return options;
}

/// For a fit from which others go on: accurate to a small part of the standard errors.
inline FitOptions rough(FitOptions options) {
  options.tolerance = 1e-6;
  return options;
}

/// A fit that is only compared with others, and begins close by: rough, and errors to within a
/// quarter. Steps are longer: smooth effects are then a few parts in a hundred thousand off.
inline FitOptions quick(FitOptions options) {
  options = rough(once(options));
  options.input_noise_draws = 8;
  options.step *= 2.0;
  return options;
}

/// For scores, which are compared by factors: smooth effects are a few parts in ten thousand off,
/// and four times as quick.
inline FitOptions coarse(FitOptions options) {
  options.step *= 4.0;
  return options;
}

/// A quick fit of a search. Its model is another one, but near: a continuation starts where the
/// residual is scored first.
inline FitOptions refit(const Job& job, int max_iterations) {
  FitOptions options = quick(job.options);
  options.max_iterations = std::min(options.max_iterations, max_iterations);
  if (options.is_continued()) options.continuation->start_gain = score_gains(job).front();
  return options;
}

/// The last fit of a search, with the full accuracy from where a refit ended: a continuation starts
/// lower still.
inline FitOptions final_fit(const Job& job) {
  FitOptions options = once(job.options);
  if (options.is_continued()) options.continuation->start_gain = score_gains(job).back();
  return options;
}

}  // namespace axisfit::recipe
