// The fit of a job, from its data to a judged result.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fit/data/simulated_recording.h"
#include "fit/errors/identifiability.h"
#include "fit/errors/parameter_result.h"
#include "fit/errors/uncertainty.h"
#include "fit/estimate/stage.h"
#include "fit/solve/run_context.h"

namespace axisfit {

/// Differences between a measured and a simulated signal.
struct SignalError {
  Signal signal = Signal::velocity;
  bool fitted = true;
  double rmse = 0.0;           ///< free-running simulation, in the signal's unit
  double nrmse_percent = 0.0;  ///< of the measured range; zero where that is none
  double sigma = 0.0;          ///< of the noise
  NoiseSource noise = NoiseSource::differences;
  double reduced_chi_square = 0.0;  ///< (rmse / sigma)^2
  /// The same with the observer at which the fit ended; only where that is not zero.
  std::optional<double> prediction_rmse, prediction_reduced_chi_square;
};

struct RecordingResult {
  SimulatedRecording free_running;  ///< free running
  /// With the observer at which the fit ended, or in the windows of its horizon; only where there
  /// are such.
  std::optional<SimulatedRecording> tracking;
  std::vector<SignalError> signals;

  /// The prediction in the way the recording was fitted.
  const SimulatedRecording& as_fitted() const { return tracking ? *tracking : free_running; }
};

/// How one start of a multistart ended.
struct StartResult {
  std::vector<double> from;
  std::vector<double> to;
  bool usable = false;
  double reduced_cost = 0.0;
};

/// Where several starts ended.
struct Minimum {
  double reduced_cost = 0.0;
  int starts = 0;
  std::vector<double> values;  ///< of the best of them
};

/// The usable ends of starts, those of equal cost (to a thousandth) taken together, best first.
std::vector<Minimum> distinct_minima(std::vector<StartResult> starts);

/// Whether a fit can be used, and what the verdict rests on.
struct FitVerdict {
  enum class Kind {
    usable,               ///< a minimum was found, and every fitted signal is followed
    not_simulated,        ///< the simulation does not finish at the initial values
    no_minimum,           ///< the iteration limit came first
    signal_not_followed,  ///< a constant would follow a fitted signal as well
  };
  Kind kind = Kind::not_simulated;
  int iteration_limit = 0;           ///< of no_minimum
  Signal signal = Signal::velocity;  ///< of signal_not_followed: the first of them
  std::size_t recording = 0;         ///< which has that signal
  /// Of a usable fit: the parameters that are neither determined nor at a bound.
  std::vector<ParameterId> undetermined{};

  bool has_minimum() const { return kind == Kind::usable || kind == Kind::signal_not_followed; }
  bool operator==(const FitVerdict&) const = default;
};

struct FitResult {
  FitVerdict verdict;
  std::string message;       ///< the solver's reason to stop
  bool interrupted = false;  ///< not all starts were finished
  std::vector<ParameterResult> parameters;
  std::vector<RecordingResult> recordings;
  /// Of what was fitted, degrees of freedom counted; not a number where nothing was.
  double reduced_chi_square = std::numeric_limits<double>::quiet_NaN();
  /// Where nothing was fitted, not finite. With respect to the u of the job as it was solved: with
  /// other initial values, linear parameters have another scale. Shared between copies, for it is
  /// large.
  std::shared_ptr<const Linearization> at_solution;
  Eigen::MatrixXd correlation;      ///< of the estimates, see uncertainty.h
  double degrees_of_freedom = 0.0;  ///< independent samples, parameters subtracted
  double autocorrelation_time =
      1.0;                          ///< samples per independent sample, of the most coloured signal
  double input_part = 0.0;          ///< that noise of the input makes, see uncertainty.h
  Identifiability identifiability;  ///< at the solution
  double observer_gain = 0.0;       ///< of the last stage
  /// 1/s, the gain whose estimates predict the recordings to validate better, see other_gains.h.
  std::optional<double> better_gain{};
  /// 1/s, a gain at which noise of the inputs would not add up, see quiet_gain().
  std::optional<double> quiet_gain{};
  int iterations = 0;         ///< of the best start, all stages
  std::vector<Stage> stages;  ///< of the best start
  std::vector<StartResult> starts;

  /// Whether a minimum was found that follows every fitted signal.
  bool is_usable() const { return verdict.kind == FitVerdict::Kind::usable; }
};

/// Where start number `start` begins: the initial values for the first, values drawn around them
/// for the others, by the job's seed and spread and the start's number alone.
std::vector<double> draw_start(const Job& job, int start);

/// Of the best start (StartResult); infinite where none is usable.
double reduced_cost(const FitResult& result);

/// The values of the free parameters.
std::vector<double> values_of(const FitResult& result);

/// Fits a job. The result depends on the job alone, not on the number of threads. When the stop
/// flag is set, it is that of the starts that were finished; Interrupted where there is none. The
/// first start is at `from` (a value for each free parameter), or if that is empty at the initial
/// values.
FitResult estimate(const Job& job, const RunContext& context = {},
                   std::span<const double> from = {});

/// Fits a job. Where the noise of a measurement is to be estimated together with the parameters, it
/// alternates: sigma in the job becomes the size of the residual, degrees of freedom counted, and
/// the job is fitted again with it, until both stay. This is the maximum of the likelihood of
/// independent normal noise. A signal has one sigma in all recordings in which it is to be
/// estimated.
FitResult estimate_with_noise(Job& job, const RunContext& context = {},
                              std::span<const double> from = {});

/// The job's model as it is, judged on its recordings: a fit without parameters. The job must have
/// none that are free.
FitResult evaluated(const Job& job);

/// The model with the estimates in place of the free quantities that all recordings share, and of
/// those of this one.
Model<double> fitted_model(const Job& job, const FitResult& result,
                           std::optional<std::size_t> recording = {});

}  // namespace axisfit
