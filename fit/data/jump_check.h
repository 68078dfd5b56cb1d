// Whether the zero of a position moves within a recording.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// A position that goes on displaced.
struct Jump {
  std::size_t at = 0;  ///< the first sample behind it
  double size = 0.0;   ///< in the signal's unit
};

/// The largest step of a position that no motion makes: an encoder that lost counts, a zero that
/// was set, or lost rows. Between two samples the position goes on by five times more, beside what
/// the speed before and behind tells, than anywhere else but at one more such step; the speed is
/// about the same before and behind, as it is not about an impact; it does not return, as an
/// outlier does; and the command, here that in force at every sample, does not change just before.
/// None of fewer than 100 samples, or where a sample beside it is missing.
std::optional<Jump> jump_of(const Recording& recording, const Measurement& position,
                            const std::vector<double>& command);

}  // namespace axisfit
