// Which estimates rest on values of the axis file that nobody knows yet.
#pragma once

#include <span>
#include <vector>

#include "fit/errors/parameter_result.h"

namespace axisfit {

/// For every parameter of a job's fit at an observer gain, the guessed quantities that it rests on:
/// those of which a change of 10 % would move it by more than its standard error, or by more than
/// 1 %. With J the
/// whitened Jacobian at the solution and g the residuals' derivative with respect to the guess, the
/// estimates move by -(J'J)^-1 J'g. Guesses of zero have no part of which to change, guessed
/// quantities that are free are estimates, and parameters that are not determined rest on nothing;
/// those at a bound stay there.
std::vector<std::vector<GuessInfluence>> guess_influences(
    const Job& job, std::span<const ParameterResult> parameters, double observer_gain,
    const ErrorOptions& options = {});

}  // namespace axisfit
