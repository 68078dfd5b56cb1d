// What was found as text for a terminal. Lines end with '\n' and have no more than 80 characters.
// With `colour`, verdicts are green, yellow or red.
#pragma once

#include <string>
#include <vector>

#include "fit/couplings.h"
#include "fit/data/recording_warnings.h"
#include "fit/design/forecast.h"
#include "fit/design/run_time_estimate.h"
#include "fit/first_look/first_look.h"
#include "fit/run.h"

namespace axisfit {

/// Recordings, table of parameters, errors per signal or the models of the loop, and the verdicts.
std::string report_text(const RunResult& run_result, bool colour = false);

/// What the runs of several axes of one machine say together; empty where that is nothing.
std::string couplings_text(const std::vector<SharedInertia>& shared);

/// Its part on a residual that is not explained: how much that is, and what it depends on.
std::string residual_text(const Job& job, const Diagnosis& diagnosis);

/// Faults of the instruments that the residual shows; empty where there are none.
std::string instruments_text(const Job& job, const Diagnosis& diagnosis);

/// What the residual may come from: the missing force and the suspects.
std::string suspected_effects_text(const Job& job, const Diagnosis& diagnosis,
                                   const std::vector<Scored>& suspects);

/// The verdict on the residual, one paragraph. `faulty`: recordings with warnings that may be the
/// cause, by their names.
std::string residual_verdict(const Job& job, const Diagnosis& diagnosis,
                             const std::vector<Scored>& suspects, bool loop_was_asked_for = false,
                             bool colour = false, const std::vector<std::string>& faulty = {});
/// That of a run that has a diagnosis. Recordings that differ from the fitted ones are left out:
/// the grade says what differs.
std::string residual_verdict(const RunResult& run_result, bool colour = false);

/// Its part on the closed loop: effects that were tried, and the errors before and after.
std::string selection_text(const RunResult& run_result, bool colour = false);

/// "step, fit: velocity"
std::string series_name(const Recording& recording, const char* role, Signal signal,
                        Vocabulary vocabulary);

/// What each parameter of a job is and, unless it is determined, its verdict.
std::string meanings_text(const Job& job, const std::vector<ParameterUncertainty>& known,
                          bool colour = false);

/// What the intervals rest on, and what is known instead of parameters that are not determined.
std::string uncertainty_text(const Job& job, const FitResult& result);

/// What the inverse-dynamics estimate did for the fit, and where it contradicts it or stands in for
/// it; empty where there is nothing to say.
std::string second_opinion_text(const RunResult& run_result);

/// "windows of 2 s"
std::string horizon_name(const Criterion& criterion);
/// By what horizon the fit was made, and why; empty where that was not chosen.
std::string horizon_text(const RunResult& run_result);

/// How the parameters differ between recordings; empty where that was not to be seen.
std::string scatter_text(const RunResult& run_result);

/// What was asked to be predicted, and how well it was; empty where nothing was.
std::string prediction_text(const RunResult& run_result);
/// Its curves: by recording and time, of every signal what was measured, what was predicted, and
/// the half widths of the bands at any one time and for the whole curve.
std::string prediction_csv(const RunResult& run_result);
/// That of the motion that nobody recorded.
std::string motion_csv(const RunResult& run_result);

/// Models side by side, and the reason to prefer one; empty where that was not asked for.
std::string comparison_text(const RunResult& run_result);

/// What is known of the parameters together: weak directions, and the combinations that are
/// determined.
std::string identifiability_text(const Job& job, const Identifiability& known);

/// Intervals by profile beside those by standard error; empty where there are no profiles.
std::string profiles_text(const RunResult& run_result);

/// The next experiment, and what it is expected to bring.
std::string suggestion_text(const RunResult& run_result);

/// What the recordings of a job can tell of its parameters, before the fit.
std::string forecast_text(const Job& job, const Forecast& forecast, bool colour = false);

/// What the recordings show by themselves: sampling, ranges, noise, and what looks wrong.
std::string recordings_text(const Job& job, const std::vector<RecordingCheck>& checks);

/// What a first look at the forces of all recordings sees, without a model; empty where it sees
/// nothing.
std::string first_look_text(const Job& job, const std::optional<FirstLook>& look);

/// What looks wrong with a recording, and what to do about it: a sentence or two.
std::string warning_text(const RecordingWarning& warning, Vocabulary vocabulary);

/// The same of all that looks wrong with a recording.
std::vector<std::string> warnings_for(const Job& job, const Recording& recording,
                                      const RecordingCheck& check);

/// How long the fit will take.
std::string run_time_text(const Job& job, const RunTimeEstimate& run_time);

/// Cells of one row about a missing force: name, rms, noise, per cent of the drive force, cutoff.
std::vector<std::string> force_cells(const std::string& name, const MissingForce& force,
                                     Vocabulary vocabulary);
/// The table of such rows.
std::string forces_table(std::string_view title, std::vector<std::vector<std::string>> rows,
                         Vocabulary vocabulary);

/// residuals.csv: recording (its number in the job), time_s, and measured, simulated and residual
/// of every signal, of the free-running simulation. With a diagnosis also the missing force and
/// what it may depend on, of the simulation that is held to the recording. Empty where a recording
/// lacks a signal.
std::string residuals_csv(const Job& job, const FitResult& result,
                          const std::optional<Diagnosis>& diagnosis = {});

}  // namespace axisfit
