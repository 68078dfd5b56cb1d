// Standstill: parts of a recording in which the arm does not move.
#pragma once

#include <optional>
#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// Which samples are at standstill: the recorded velocity (or else the slope of the recorded
/// position) does not differ from zero by more than its noise, in the mean over 25 samples and for
/// at least twice as long. Empty when neither was recorded.
std::vector<bool> at_standstill(const Recording& recording);

/// Standard deviation of a signal at standstill, about the mean of each part; zero where the
/// recording has no standstill.
double noise_at_standstill(const Recording& recording, const Measurement& measurement);

/// Excludes the acceleration at standstill. The arm has no acceleration there whatever its
/// parameters are, so the accelerometer shows only a bias, which it also has in motion, or an
/// artefact.
void exclude_acceleration_at_standstill(Recording& recording);

/// Samples of a signal that do not count, since the arm rests.
struct ExcludedSamples {
  std::size_t samples = 0;
  double mean = 0.0;             ///< of what was measured there
  bool is_within_noise = false;  ///< whether that mean is no further from zero than noise would be
};
std::optional<ExcludedSamples> excluded_samples(const Measurement& measurement);

}  // namespace axisfit
