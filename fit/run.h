// The result of a run of fit-params: the fit, what it leaves unexplained, and the models that were
// tried to explain that. Text and JSON are made from it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/work_times.h"
#include "fit/data/job.h"
#include "fit/data/recording_check.h"
#include "fit/design/discrimination.h"
#include "fit/design/experiment.h"
#include "fit/errors/scatter.h"
#include "fit/estimate/estimate.h"
#include "fit/estimate/horizon.h"
#include "fit/estimate/profile.h"
#include "fit/judge/diagnosis.h"
#include "fit/judge/grade.h"
#include "fit/judge/model_score.h"
#include "fit/judge/other_day.h"
#include "fit/judge/second_opinion.h"
#include "fit/predict/comparison.h"
#include "fit/predict/prediction.h"
#include "fit/search/scored.h"
#include "fit/search/select_effects.h"

namespace axisfit {

/// An allowed error of the signals that have this unit.
struct Tolerance {
  double value = 0.0;
  std::string unit;
};

/// A model of the machine that was fitted elsewhere.
struct OtherModel {
  std::string name;
  Model<double> model;
  std::optional<AxisUncertainty> uncertainty;
};

/// What to do beyond the fit.
struct RunOptions {
  bool select_effects = false;              ///< add the effects that the model lacks
  std::vector<ParameterId> profiles{};      ///< of these free parameters of the job
  bool profile_all = false;                 ///< of all, and of those of added effects
  bool suggest_experiment = false;          ///< suggest the motion to record next
  bool predict = false;                     ///< the recordings to validate, with bands
  std::optional<MotionToPredict> motion{};  ///< with `predict`: that as well
  std::vector<Tolerance> tolerances{};      ///< for which the bands are judged
  bool compare = false;                     ///< the models of the search, and others
  std::vector<OtherModel> others{};         ///< of the same machine, to be compared
};

/// What a stop leaves of the errors of the estimates.
enum class ErrorsKnown {
  fully,           ///< there was no stop, or a later one
  to_first_order,  ///< moves to other observer gains by one step of least squares, no rivals
  no,              ///< there was no time even for that: estimates have no error
};

struct RunResult {
  Job baseline;  ///< the job as given, with the noise if that was estimated
  RunOptions options;
  std::optional<HorizonChoice> horizon;                  ///< where the job lets it be chosen
  FitResult first;                                       ///< fit of the baseline model
  InverseStart inverse_start = InverseStart::not_tried;  ///< what the first fit owes to it
  std::vector<RecordingCheck> checks;                    ///< of each recording
  /// None unless it was asked for and the first fit is usable.
  std::optional<EffectSelection> selection;
  /// The search found something only with the roles of the recordings exchanged; they are exchanged
  /// in `baseline`, `first` and all that follows.
  bool roles_exchanged = false;
  std::vector<ModelScore> scores;               ///< of the search's models
  std::optional<Diagnosis> diagnosis;           ///< of the final model; none unless that is usable
  std::vector<Scored> suspects;                 ///< of a fit without a search that is not explained
  std::vector<OtherDay> other_days;             ///< recordings that differ in a few parameters
  FitGrade grade;                               ///< of the final model, with those for these
  std::optional<SecondOpinion> second_opinion;  ///< of the final model, where there can be one
  std::optional<Scatter> scatter;               ///< of the final model, in its errors
  ErrorsKnown errors_known = ErrorsKnown::fully;
  std::optional<AxisUncertainty> uncertainty;    ///< of the final model, where that is usable
  std::vector<RecordingPrediction> predictions;  ///< by the final model, where asked for
  std::optional<MotionPrediction> motion;        ///< by the final model, where asked for
  std::string no_prediction;                     ///< why there can be none
  std::optional<Comparison> comparison;          ///< of models, where it was asked for and can be
  std::vector<Profile> profiles;                 ///< of the final model, those asked for
  std::vector<Discrimination> discriminations;   ///< of the search's substitutions, one by one
  std::optional<Suggestion> suggestion;          ///< of the next experiment, where it was asked for
  bool interrupted = false;                      ///< not all that was asked for was finished
  std::optional<double> time_limit{};            ///< s, if a time limit was what interrupted it
  double wall_time = 0.0;                        ///< s
  std::array<WorkTime, kWorkNames.size()> times{};  ///< of which each kind of work took so much

  /// Job and fit of the final model: the result of the search, or else the baseline.
  const Job& job() const { return selection ? selection->result.job : baseline; }
  const FitResult& fit() const { return selection ? selection->result.fit : first; }
};

/// Whether the noise of any measurement of a job comes from this source.
bool has_noise_from(const Job& job, NoiseSource source);

/// The experiment to make next, where it was asked for and there is one: the one that discriminates
/// undecided effects, or else the one that determines the parameters.
const Experiment* next_experiment(const RunResult& result);

/// Fits the job, analyses its residual and does what the options ask for: all that fit-params does
/// between reading its files and writing its results. Throws std::invalid_argument if the job
/// breaks a rule (validate()) or a parameter that is to be profiled is not free, and Interrupted if
/// it is stopped before one start of the fit has finished; stopped later, it returns what is
/// finished.
RunResult run(Job job, const RunOptions& options = {}, const RunContext& context = {});

/// A free parameter of the final model with the user's initial value, which the search does not
/// keep; of an added effect, with the one it was started from.
const FreeParameter& as_specified(const RunResult& result, std::size_t parameter);

}  // namespace axisfit
