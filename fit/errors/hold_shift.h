// What the estimates owe to how the input goes from one of its samples to the next.
//
// A drive holds each value of its command until the next; what was measured goes about straight
// from sample to sample. Nothing in a log says which it is, and the wrong one shifts the force by
// half a sample: a short delay or a small inertia takes that upon itself.
#pragma once

#include <optional>
#include <vector>

#include "fit/errors/parameter_result.h"
#include "fit/solve/linearization.h"

namespace axisfit {

/// The recordings with the other hold of their commands. References of a controller stay.
Job with_other_hold(Job job);

/// For every parameter of a fit, its value with the other hold where that is more than its standard
/// error away, by the problem linearised at the estimates. None where the recordings exclude the
/// other hold, and for what is not determined. `excess` is the variance of a residual, with its
/// autocorrelation, over that of the noise. Costs one simulation of each recording.
std::vector<std::optional<HoldShift>> hold_shifts(const Job& job,
                                                  std::span<const ParameterResult> parameters,
                                                  const Linearization& at_solution, double excess,
                                                  double observer_gain,
                                                  const ErrorOptions& options = {});

}  // namespace axisfit
