// What a fit minimises: the squared residuals of a simulation, over one of three horizons. The
// horizon is how far ahead the simulation predicts before the recording corrects it.
//
// A complete model has the same parameters with every horizon. An incomplete one has different
// parameters with each: what it lacks adds up over the horizon, and the estimates compensate for
// it.
//
// - FreeRun asks for the whole motion from the command alone. It assumes that nothing is missing
//   that adds up, and that the inputs are exact: then only noise of the readings is left, and no
//   other estimate is sharper (an output-error fit). Take it first.
// - Windows ask for the motion over `length` from any state on. An error of the model adds up
//   within a window alone. Take them where something slow is missing, such as a force that wanders;
//   each window costs two fitted states.
// - Tracking asks for the force from sample to sample, within 1 / gain (a prediction-error fit). It
//   forgets what came before, noise of the inputs included. It assumes that the tracked signal is
//   not late, and not too noisy for the gain. Take it where the input is noisy, or where much is
//   missing.
//
// Literature: L. Ljung, System Identification, 2nd ed., Prentice Hall 1999, chapters 7 and 8.
#pragma once

#include <variant>

namespace axisfit {

/// The free run of the whole recording.
struct FreeRun {
  bool operator==(const FreeRun&) const = default;
};

/// Free runs in windows, each from a fitted state, see windows.h.
struct Windows {
  double length = 0.0;  ///< s, > 0; about that of every window
  bool operator==(const Windows&) const = default;
};

/// One step ahead: the observer stays to the end.
struct Tracking {
  /// 1/s (velocity recorded) or rad/s (position alone); zero: as high as the sampling allows.
  double gain = 0.0;
  bool operator==(const Tracking&) const = default;
};

using Criterion = std::variant<FreeRun, Windows, Tracking>;

inline bool tracks(const Criterion& criterion) {
  return std::holds_alternative<Tracking>(criterion);
}

/// s; zero where there are no windows.
inline double window_length(const Criterion& criterion) {
  const auto* windows = std::get_if<Windows>(&criterion);
  return windows != nullptr ? windows->length : 0.0;
}

/// Tracking::gain; zero where nothing tracks.
inline double given_gain(const Criterion& criterion) {
  const auto* tracking = std::get_if<Tracking>(&criterion);
  return tracking != nullptr ? tracking->gain : 0.0;
}

/// How a free run or windows are approached from poor initial values: by fits whose observer gain
/// falls to zero, see continuation.h.
struct Continuation {
  double start_gain = 0.0;  ///< where it starts; zero: as high as the sampling allows
  bool operator==(const Continuation&) const = default;
};

}  // namespace axisfit
