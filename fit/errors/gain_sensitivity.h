// How estimates at a fixed observer gain depend on that gain.
//
// A simulation that tracks its recording (observer mode fixed) weighs what the model lacks by the
// observer gain: a low one asks for the course over a second, a high one for the force from sample
// to sample. Where the model lacks nothing the estimates agree, whatever the gain. Where
// they do not, no standard error from one of them is honest, and which of them is right only a
// recording that was not fitted can tell.
#pragma once

#include "fit/estimate/estimate.h"
#include "fit/solve/run_context.h"

namespace axisfit {

/// Fits a job of fixed observer gain again at a third and at three times that gain, from the fit's
/// values. An estimate that moves by more than twice the standard errors of both together is given
/// the move as a further, independent error: ParameterResult::gain_shift tells it. A gain whose
/// estimates predict the recordings to validate clearly better, simulated freely, becomes
/// FitResult::better_gain. Of other jobs, and of a fit that is not usable, nothing changes.
void allow_for_observer_gain(const Job& job, FitResult& fit, const RunContext& context = {});

/// An uncertainty with a further independent error (the quantity's unit) of the estimate `value`:
/// the interval grows in proportion, on a logarithmic scale about the logarithm, within the bounds.
/// One without a standard error stays as it is.
ParameterUncertainty widened(ParameterUncertainty known, double value, const FreeParameter& free,
                             double further_error);

}  // namespace axisfit
