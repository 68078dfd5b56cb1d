// Noise of the recorded inputs, which drives the simulation but never drove the axis.
#pragma once

#include "fit/solve/linearization.h"
#include "fit/solve/parameters.h"

namespace axisfit {

/// Simulates every `fit` recording at u with draws of its command's noise
/// (Recording::command_sigma) added to the command: errors of the input then pass through the same
/// model, events included, as the input itself. `at` is the linearization there. Nothing where
/// every input is exact, or `at` is not finite.
///
/// Where the noise was estimated from differences, a part of it may have moved the axis. The draws
/// are therefore scaled down to where the smallest of them is no larger than the residual.
///
/// The draws are always the same, whatever the number of threads. To first order the noise leaves
/// no bias (what it does to the Jacobian is of second order), and its part of the covariance of the
/// estimates is (J'J)^-1 J' E[dd'] J (J'J)^-1.
std::optional<InputNoise> input_noise(const Job& job, const ParameterSpace& space,
                                      const Eigen::VectorXd& u, double observer_gain,
                                      const Linearization& at);

}  // namespace axisfit
