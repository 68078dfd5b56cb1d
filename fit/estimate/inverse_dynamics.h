// The inverse-dynamics estimate: parameters by least squares on the balance of forces along the
// measured motion, without a simulation.
//
// Where the drive force is known from the recording, the forces that the model predicts along the
// measured trajectory must add up to M a at every instant. That is linear in masses, frictions and
// most strengths of effects, so that there are no local minima, and no simulation that has to
// finish: a start where there is none, and a second opinion where there is. It suffers from noise
// in the velocity and acceleration, as a simulation does not; but a force that the model lacks adds
// up in a simulation, and not in a balance of forces.
//
// Literature: A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for
// industrial robot identification", IEEE Transactions on Control Systems Technology 22 (2014),
// which has the filters: zero-phase Butterworth filters and central differences for the motion, and
// one low-pass for both sides of the balance, after which samples are left out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/estimate/estimate.h"

namespace axisfit {

/// One parameter of the estimate.
struct InverseEstimate : ParameterResult {
  std::size_t parameter = 0;  ///< its place in Job::free
};

struct InverseDynamics {
  /// The parameters that the balance of forces determines, in the order of Job::free. Errors and
  /// intervals as those of a fit, with the autocorrelation of the balance (uncertainty.h).
  std::vector<InverseEstimate> parameters;
  double cutoff = 0.0;     ///< Hz, up to which forces are balanced: of the recording where it is
                           ///< lowest
  double residual = 0.0;   ///< N rms on the arm side, what remains of the balance
  double drive_rms = 0.0;  ///< N, of the drive force, alike
  bool exact = true;  ///< false: the transmission was taken to be rigid, and no mode to be elastic
};

/// Weighted least squares with the model's own equations,
///
///   m (a - y1'(v, y0, U(t - T_d))) = 0,  m the moving mass,
///
/// over the recordings to be fitted whose drive force is known: from the command of a force source,
/// or from the recorded motor current of an electric drive (K_m y6 / r_g). Backlash is treated as
/// if the transmission were rigid. The velocity is the recorded one, or else that of the position.
/// Samples at rest, where friction may have any value, do not count. Recordings are weighted by
/// what remains of their balance.
///
/// Parameters of instruments and of the initial state stay at their initial values; so does the
/// gain of the drive (K_f, K_m, r_g) where M is free, since forces are known only up to a factor
/// then. None where no drive force is known, or where the balance determines nothing. Repeatable;
/// costs about as much as a simulation with its Jacobian.
std::optional<InverseDynamics> inverse_dynamics(const Job& job);

/// The initial values of a job, with those of the estimate in their places.
std::vector<double> start_from(const Job& job, const InverseDynamics& estimate);

}  // namespace axisfit
