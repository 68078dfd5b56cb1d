// Observer-gain continuation, for convergence from poor starts: the fit begins with a tracking
// simulation at a high observer gain, which is lowered to zero, the free run.
//
// The cost of a free-running simulation of a ringing axis has local minima everywhere; with a high
// observer gain it is nearly quadratic in the parameters and has one. Literature: homotopy and
// synchronisation-based parameter identification, e.g. C. P. Vyasarayani et al., Nonlinear Dynamics
// 67 (2012); H. D. I. Abarbanel, Predicting the Future (2013).
// docs/decisions/0002-observer-gain-continuation.md.
#pragma once

#include <functional>

#include "fit/estimate/stage.h"
#include "fit/solve/solve.h"

namespace axisfit {

struct ContinuationResult {
  SolveResult last;  ///< the best end of an attempt; `iterations` is the sum over all stages
  std::vector<Stage> stages;  ///< of all attempts, in turn
};

/// The observer gain at which the continuation starts by default: as high as the sampling allows, 1
/// per sample interval for a recorded velocity and 0.3 for position alone.
double initial_observer_gain(const Job& job);

/// The observer gain at which the fit ends: zero unless the job fixes it.
double final_observer_gain(const Job& job);

/// Fits from u, through all stages of job.options.observer. `progress` is called after every stage.
ContinuationResult run_continuation(const Job& job, const ParameterSpace& space,
                                    const Eigen::VectorXd& u,
                                    const std::function<void(const Stage&)>& progress = {},
                                    const RunContext& context = {});

}  // namespace axisfit
