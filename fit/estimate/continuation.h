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

/// Fits from u: from highest_gain() down to the free run, and again from elsewhere while the end
/// does not explain the recordings; or at final_gain() alone, where the job has no continuation or
/// nothing can be tracked. `progress` is called after every stage.
ContinuationResult run_continuation(const Job& job, const ParameterSpace& space,
                                    const Eigen::VectorXd& u,
                                    const std::function<void(const Stage&)>& progress = {},
                                    const RunContext& context = {});

}  // namespace axisfit
