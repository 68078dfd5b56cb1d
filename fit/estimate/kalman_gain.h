// The rungs of the ladder of gains (fit/criterion/gains.h) that noise of the recorded inputs and of
// the readings asks for.
#pragma once

#include <optional>
#include <vector>

#include "fit/estimate/estimate.h"

namespace axisfit {

/// The gain (1/s, observer_for()) of the steady Kalman filter of a mass that the inputs' noise
/// accelerates, at these values of the free parameters: with it the errors of a prediction one step
/// ahead are white. At a lower one noise of the inputs adds up in the simulation, at a higher one
/// that of the readings drives it. The lowest of all `fit` recordings, and no higher than
/// highest_gain(). Nothing where every input is exact, or no simulation can track.
///
/// Noise of standard deviation s_a in the acceleration, s_x in a recorded position or s_v in a
/// recorded velocity, from sample to sample, gives a bandwidth of sqrt(s_a / s_x) or s_a / s_v. In
/// a job's units, s_a follows from the effect of the noise on a tracking simulation.
std::optional<double> kalman_gain(const Job& job, const std::vector<double>& values);

/// The same gain for a free run that noise of the inputs moves by more than three times the noise
/// of the readings: its residual says little of the model, and its estimates err more than those of
/// a fit that tracks. Nothing for any other fit.
std::optional<double> quiet_gain(const Job& job, const FitResult& fit);

/// Whether a search that was `asked` for a free run came to track because of that noise. A
/// criterion that is chosen may be to track, too: that is what was asked for.
bool had_to_track(const Job& asked, const Job& used);

}  // namespace axisfit
