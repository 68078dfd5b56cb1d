// Periods of a force along the stroke that a residual shows.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/interrupt.h"
#include "fit/solve/residual.h"

namespace axisfit {

/// The periods (m) at which a force sin, cos(2 pi y0 / period) on the arm explains most of the
/// residuals, best first, at most `most` of them, from the stroke down to what sampling shows: of a
/// longer one the recording has no period. `residuals` are those of one recording, as RecordingCost
/// orders them, and `basis` spans what the free parameters explain of them already, in orthonormal
/// columns of as many rows. With `of_drive` the force is in proportion to the drive's, as that of a
/// ripple of its torque.
///
/// Throws Interrupted when the stop flag is set.
///
/// A spectrum in space. The response to the force is that of a rigid axis with the observer:
/// accurate enough to find a period, not to assess it.
std::vector<double> periods_in(const Recording& recording, const SimulatedRecording& simulation,
                               const Observer& observer, const Eigen::VectorXd& residuals,
                               const Eigen::MatrixXd& basis, std::size_t most, bool of_drive,
                               const StopFlag* stop = nullptr);

}  // namespace axisfit
