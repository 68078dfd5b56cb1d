// The least-squares problem that a job poses at one observer gain.
#pragma once

#include "fit/solve/least_squares.h"
#include "fit/solve/run_context.h"

namespace axisfit {

/// Minimises over all `fit` recordings, from u, within the bounds, with the observer gain
/// (observer_for each recording). The solution is the same for any number of threads. One that the
/// journal knows is taken from there; others are stored in it. Throws Interrupted when the stop
/// flag is set.
SolveResult solve(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                  double observer_gain, SolveOptions options, const RunContext& context = {});

/// Residuals of all fit recordings and then of the priors at u, and their Jacobian with respect to
/// u.
Linearization linearize(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                        double observer_gain);
/// The same at the solution that solve() found with this gain; it may be known from there.
Linearization linearize(const Job& job, const ParameterSpace& space, const SolveResult& solved,
                        double observer_gain);

/// The residuals alone; none where a simulation does not finish.
Eigen::VectorXd residuals_at(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                             double observer_gain);

}  // namespace axisfit
