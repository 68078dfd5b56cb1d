// What recorded signals show of a force on a rigid axis that tracks them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fit/data/job.h"
#include "sim/observer.h"

namespace axisfit {

/// What the residuals of a recording, in the order of RecordingCost, show of a force (N, at each
/// sample) on a rigid axis of 1 kg with the observer, in units of sigma and with the sign of the
/// readings. For double and std::complex<double>.
template <class T>
Eigen::VectorX<T> response_to(const Recording& recording, const std::vector<T>& force,
                              const Observer& observer);

/// The adjoint of that: the g for which the product of any force f with g is that of
/// response_to(f) with `rows`.
std::vector<double> adjoint_response(const Recording& recording, const Eigen::VectorXd& rows,
                                     const Observer& observer);

}  // namespace axisfit
