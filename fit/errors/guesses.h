// Which estimates rest on values of the axis file that nobody knows yet.
#pragma once

#include <span>
#include <vector>

#include "fit/errors/parameter_result.h"

namespace axisfit {

/// For every parameter of a job's fit at an observer gain, the guessed quantities that it rests on:
/// changing one of them by 10 % would move it by more than 1 % or its standard error. With J the
/// whitened Jacobian at the solution and g the residuals' derivative with respect to the guess, the
/// estimates move by -(J'J)^-1 J'g. Not counted are guesses of zero, which no percentage changes,
/// and guessed quantities that are free. Parameters that are not determined rest on nothing; those
/// at a bound stay there.
std::vector<std::vector<GuessInfluence>> guess_influences(
    const Job& job, std::span<const ParameterResult> parameters, double observer_gain,
    const ErrorOptions& options = {});

}  // namespace axisfit
