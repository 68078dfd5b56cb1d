// Predictions of motions that a model was not fitted to, and how far to trust them.
//
// The parameters have errors, and scatter from recording to recording. A force that the model lacks
// acts besides: it is measured in the fitted recordings, without the part that other parameters
// would make. All three are drawn together and simulated (sim/ensemble.h), free running, for a
// prediction has nothing to track.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fit/errors/scatter.h"
#include "fit/estimate/estimate.h"
#include "fit/judge/missing_force.h"
#include "fit/judge/series.h"
#include "fit/solve/run_context.h"
#include "sim/axis_uncertainty.h"
#include "sim/ensemble.h"
#include "sim/rig.h"

namespace axisfit {

/// The uncertainty of a fitted axis, with the missing force of each of its recordings. Parameters
/// that belong to one recording, are at a bound, or are left open by the data are taken as they
/// are.
AxisUncertainty axis_uncertainty(const Job& job, const FitResult& fit,
                                 const std::optional<Scatter>& scatter,
                                 std::span<const MissingForce> forces);

struct SignalPrediction : SeriesKey {
  std::vector<double> values;  ///< of the fitted model, one per sample, in the signal's unit
  Band band;                   ///< of readings, their noise included
  double rmse = std::numeric_limits<double>::quiet_NaN();  ///< of the free run, in that unit
  double inside_percent = std::numeric_limits<double>::quiet_NaN();  ///< of what was measured
  bool is_whole_inside = false;  ///< in the wider band, from the first sample to the last
};

struct RecordingPrediction {
  std::size_t recording = 0;
  std::size_t draws = 0;                  ///< of the ensemble, that were simulated to the end
  std::vector<SignalPrediction> signals;  ///< none where the draws are too few for a band
};

/// Predicts the recordings to validate. Throws Interrupted.
std::vector<RecordingPrediction> predict_recordings(const Job& job, const FitResult& fit,
                                                    const AxisUncertainty& uncertainty,
                                                    const RunContext& context = {});

/// A motion that nobody has recorded, of a rig: its controller, noise and names are the machine's.
struct MotionToPredict {
  std::string name;
  Motion motion;
  double duration = 0.0;  ///< s
  Rig rig;
};

struct MotionPrediction {
  std::string name;
  std::vector<Signal> signals;
  std::vector<Column> columns;  ///< those of record_with_bands()
};

/// Predicts the signals that were recorded, by the fitted model, at the sampling rate of the first
/// recording. Throws std::runtime_error where the motion cannot be simulated or has no band.
MotionPrediction predict_motion(const Job& job, const FitResult& fit,
                                const AxisUncertainty& uncertainty, MotionToPredict motion);

}  // namespace axisfit
