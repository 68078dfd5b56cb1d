// Phases of a recording in which the arm rests.
#pragma once

#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// Which samples fall into a rest: the recorded velocity (or else the slope of the recorded
/// position) does not differ from zero by more than its noise, in the mean over 25 samples and for
/// at least twice as long. Empty when neither was recorded.
std::vector<bool> at_standstill(const Recording& recording);

/// Standard deviation of what a signal shows at rest, each rest about its own mean; zero where the
/// recording has no rest.
double noise_at_standstill(const Recording& recording, const Measurement& measurement);

/// Leaves the acceleration out where the arm rests. An arm at rest has no acceleration whatever its
/// parameters are, so nothing is lost but what the accelerometer itself has there: a bias, which it
/// shows in motion too, or an artefact.
void exclude_acceleration_at_standstill(Recording& recording);

}  // namespace axisfit
