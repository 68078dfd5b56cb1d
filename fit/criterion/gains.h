// The ladder of observer gains: how closely a simulation tracks its recording, from the highest
// gain that the sampling allows down to zero, the free run.
//
//   rung             who asks for it, and why
//   highest_gain()   The continuation starts there, unless the job gives a gain: close to the data
//                    the cost has one minimum. Tracking without a gain of its own stays there.
//   close_gain()     (fit/search/score.h) A score test of what is large, the highest of three from
//                    highest_gain() down to a tenth of it: what is missing shows where it acts.
//   kalman_gain()    (fit/estimate/kalman_gain.h) Where the inputs are noisy: a lower gain lets
//                    their noise add up, a higher one lets in that of the readings. A search that
//                    tracks goes no lower.
//   quiet_gain()     (fit/estimate/kalman_gain.h) The same, for a free run that noise of the inputs
//                    moves so far that it should track.
//   score_gains()    Score tests in any case: a 10th, a 30th and a 100th of the highest. At the
//                    first the simulation is where the machine was, so that a score holds; lower
//                    there is less noise, and what is slow shows. Refits of a search start at the
//                    first of them, its final fit at the last.
//   search_gain()    A search that tracks throughout does so at a 30th of the highest, or where the
//                    inputs are noisy at kalman_gain() if that is higher.
//   1 / duration     Below it an observer does nothing: the continuation goes on to zero.
//   final_gain()     The fit ends there: zero, or that of Tracking.
//
// Any of them is 1/s on a recorded velocity, rad/s on a position alone.
#pragma once

#include <vector>

#include "fit/data/job.h"
#include "sim/observer.h"

namespace axisfit {

/// The observer of a recording with this gain: of its velocity, or else of its position, or none.
Observer observer_for(const Recording& recording, double gain);

/// Whether an observer can track any recording to be fitted.
bool can_track(const Job& job);

/// The gain that the job gives, or else the highest that the sampling allows: 1 per sample interval
/// for a recorded velocity and 0.3 for position alone, of the recording to be fitted where that is
/// lowest. Infinite where nothing can be tracked.
double highest_gain(const Job& job);

/// The gain at which the fit ends: zero unless it tracks to the end.
double final_gain(const Job& job);

/// Whether the job lets the search choose the gains at which it scores.
bool has_choice_of_gains(const Job& job);

/// The gains at which a job's residual is always scored, the highest first; only one where there is
/// no choice.
std::vector<double> score_gains(const Job& job);

/// The gain of a search that tracks throughout.
double search_gain(const Job& job);

}  // namespace axisfit
