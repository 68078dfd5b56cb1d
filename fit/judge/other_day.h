// Recordings of another day: to validate, and of the same machine, but warmer, on a table that
// tilts a little, or with another payload.
//
// Such a recording shows a missing force that those which were fitted lack, although the model is
// right. On trial it gets offset, friction and mass of its own, as few of them as do, from its
// first half alone; what the model then leaves of the second half, which none of them has seen,
// tells whether that is what differs.
#pragma once

#include <optional>
#include <vector>

#include "fit/judge/diagnosis.h"
#include "fit/judge/options.h"

namespace axisfit {

struct OtherDay {
  std::size_t recording = 0;
  std::vector<std::size_t> differing{};       ///< places in Job::free of what differs there, ...
  std::vector<ParameterResult> parameters{};  ///< ... and the estimates of its first half
  /// Missing force of the second half, in per cent of the drive's, with the parameters of the fit
  /// and with those of its own.
  double percent_before = 0.0, percent = 0.0;
  RecordingResult result{};  ///< of all of it, with its own
  MissingForce force{};      ///< likewise
};

/// Those of a usable fit, or of one that only recordings to validate speak against. What differs
/// are free parameters of offset, dry and viscous friction, and the mass.
std::vector<OtherDay> other_days(const Job& job, const FitResult& fit, const Diagnosis& diagnosis,
                                 const GradeOptions& options = {}, const RunContext& context = {});

}  // namespace axisfit
