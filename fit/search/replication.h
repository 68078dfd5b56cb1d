// Whether other recordings, fitted by themselves, tell the same of an effect.
#pragma once

#include <optional>
#include <vector>

#include "fit/estimate/estimate.h"
#include "fit/search/hypothesis.h"
#include "fit/search/options.h"

namespace axisfit {

/// A fit of the same model to the recordings to validate alone, from the values of a fit to the
/// others. What differs between recordings (friction of the day, an offset, the phase of a ripple
/// after homing) is estimated anew, so that it hides nothing. Nothing where no recording is to
/// validate, where a parameter belongs to one recording, or where there is no usable fit.
std::optional<FitResult> fit_elsewhere(const Job& job, const FitResult& fit,
                                       const SearchContext& context = {});

/// What two fits to different recordings say of one effect.
struct Replication {
  std::vector<ParameterResult> parameters;  ///< of the effect, as found elsewhere
  bool is_alike = false;
  bool is_near = false;  ///< alike but for the distance from zero: neither proof nor objection
  /// An effect with a phase is beyond doubt in both, and has another period there. A slow
  /// disturbance looks like part of a period, of another one in every recording.
  bool has_other_period = false;
};

/// Alike are estimates that are determined in both, far from zero in both, and near each other by
/// their standard errors or by a part of their size (SearchOptions::Replication). Where there is
/// a phase, only the amplitude counts. A curve is never alike: it fits whatever there is. Both fits
/// are of the job.
Replication replication(const Job& job, const FitResult& fit, const FitResult& elsewhere,
                        const Hypothesis& hypothesis, const SearchOptions& options = {});

}  // namespace axisfit
