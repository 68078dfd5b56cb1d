// What a motion and its command show together: a command without its sign, and a hard stop.
#pragma once

#include <optional>
#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// A motion that ends on a hard stop.
struct HardStop {
  double at = 0.0;           ///< s, where the arm has lost its speed
  double last_before = 0.0;  ///< s, the last sample that the stop does not touch
};

/// The hard stop against which the arm ends: its speed falls to next to nothing within two samples,
/// four times as fast as it changes anywhere else, while the drive still pushes, and for at least
/// 25 samples, to the end of the recording, it stays there, which is the end of its way. `command`
/// is that in force at every sample. Nothing without a position or a velocity.
std::optional<HardStop> hard_stop(const Recording& recording, const std::vector<double>& command);

/// Whether the command lacks its sign: it has one sign only, the arm goes both ways, and the
/// command explains its motion where it acts in the direction of the motion, but not as it is.
/// `command` is that in force at every sample. False without a position or a velocity.
bool is_magnitude(const Recording& recording, const std::vector<double>& command);

}  // namespace axisfit
