// The initial state of a recording from its own first samples.
#pragma once

#include <cstddef>
#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// Value and slope of a signal at a sample, and their standard errors.
struct LocalCourse {
  double value = 0.0, slope = 0.0;
  double value_error = 0.0, slope_error = 0.0;
};

/// The course at `sample` of a cubic through `count` samples from `first` on, or as many as there
/// are. Its errors follow from the residuals, or from the stated noise where that is larger. With
/// fewer than four samples it is the sample itself.
LocalCourse local_course(const std::vector<double>& times, const std::vector<double>& values,
                         std::size_t first, std::size_t count, std::size_t sample,
                         double noise = 0.0);

/// The course at the first sample, of a cubic through the first `count` samples, or through fewer
/// of them, where a cubic leaves more than twice the noise: a drive that is switched on, or teeth
/// that meet, make a corner that no cubic has. Where none goes through five, of the line through
/// the first two.
LocalCourse first_course(const std::vector<double>& times, const std::vector<double>& values,
                         std::size_t count, double noise);

/// Arm position and velocity at the first sample, from the recording's first `initial_samples`
/// (first_course()): the velocity is that of the recorded velocity, or else the slope of the
/// position. Adds them to the recording's overrides as initial.y0 and initial.y1, unless they are
/// there, and are known. What was not recorded is not set.
void initial_state_from_data(Recording& recording);

/// Standard errors of an initial state that was taken from the samples, from their noise and the
/// residuals of the cubic; zero where it was not, or is known.
struct InitialErrors {
  double position = 0.0;  ///< m
  double velocity = 0.0;  ///< m/s
};
InitialErrors initial_errors(const Recording& recording);

}  // namespace axisfit
