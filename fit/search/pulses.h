// Times at which a residual shows a pulse of force.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fit/data/job.h"
#include "sim/observer.h"

namespace axisfit {

/// A force that acts from `start` to `end` (s), and how much of a sum of squares it explains.
struct Pulse {
  double start = 0.0, end = 0.0;
  double gain = 0.0;
};

/// The pulses, even while they last, that explain most of the residuals, best first: at most
/// `most`, no two of them at once, from a few samples to a quarter of the recording long.
/// `residuals` and `basis` as in periods_in(), and so is the response to a force.
std::vector<Pulse> pulses_in(const Recording& recording, const Observer& observer,
                             const Eigen::VectorXd& residuals, const Eigen::MatrixXd& basis,
                             std::size_t most);

}  // namespace axisfit
