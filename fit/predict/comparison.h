// Models side by side, on recordings that none of them was fitted to.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "fit/estimate/estimate.h"
#include "fit/judge/missing_force.h"
#include "fit/solve/run_context.h"
#include "sim/axis_uncertainty.h"

namespace axisfit {

/// A model that is to be compared, with its uncertainty.
struct ModelEntry {
  std::string name;  ///< empty: the declared one
  Job job;
  FitResult fit;  ///< of no parameters, see evaluated(), where it is taken as it is
  std::optional<AxisUncertainty> uncertainty{};
  std::vector<MissingForce> forces{};  ///< of every recording
};

/// A job with another model of its machine, which is taken as it is.
Job with_model(Job job, const Model<double>& model);

/// How a model does on the recordings to validate. Not a number, or none: not available.
struct ComparedModel {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::string name;
  std::vector<ParameterResult> parameters;  ///< that were fitted
  double missing_force = kNone;             ///< N rms
  /// Rms error of free runs over each horizon, per standard deviation of the signals.
  std::vector<double> free_running;
  double inside_percent = kNone;     ///< of what was measured, in the 95 % band at any one time
  int curves = 0, whole_inside = 0;  ///< signals of recordings, and how many the wider band holds
  /// Information criteria of the fitted samples, their residual taken as an autoregression.
  double aic = kNone, bic = kNone;
  /// Over windows of the judged horizon: the mean logarithm of the ratio of the errors to the
  /// preferred model's, its standard error, and the number of windows in which the preferred
  /// model's error is smaller.
  double log_ratio = 0.0, log_ratio_error = 0.0;
  int windows_lost = 0;
};

struct Comparison {
  std::vector<double> horizons;  ///< s; zero: the whole recordings
  double judged = 0.0;           ///< s, the one by which a model is preferred
  int windows = 0;               ///< of that length, in the recordings to validate
  std::vector<ComparedModel> models;
  /// The model with the smallest error over the judged horizon (mean of logarithms over its
  /// windows), or one fitted with fewer parameters whose error is not larger by more than two
  /// standard errors.
  std::size_t preferred = 0;
};

/// Compares models of the same recordings; none without a recording to validate, and where none of
/// them can be simulated. Costs an ensemble of simulations per model and recording.
/// Throws Interrupted.
std::optional<Comparison> compare_models(const std::vector<ModelEntry>& models,
                                         const RunContext& context = {});

}  // namespace axisfit
