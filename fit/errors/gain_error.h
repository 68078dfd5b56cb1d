// How estimates at a fixed observer gain depend on that gain.
//
// A simulation that tracks its recording (observer mode fixed) weighs what the model lacks by the
// observer gain: a low one asks for the course over a second, a high one for the force from sample
// to sample. Where the model lacks nothing the estimates agree, whatever the gain. Where they do
// not, no standard error from one of them is honest, and only a recording that was not fitted can
// tell which of them is right.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fit/errors/parameter_result.h"

namespace axisfit {

/// The same parameters, by a fit at another observer gain.
struct EstimatesAtGain {
  double observer_gain = 0.0;  ///< 1/s
  std::vector<ParameterResult> parameters;
};

/// For every parameter, the furthest move that is more than twice the standard errors of both
/// estimates together; none where there is no such move, or one of them is not determined.
std::vector<std::optional<GainShift>> gain_errors(std::span<const ParameterResult> parameters,
                                                  std::span<const EstimatesAtGain> others,
                                                  const ErrorOptions& options = {});

}  // namespace axisfit
