#include "fit/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <stdexcept>

#include "base/parallel.h"
#include "fit/data/validation.h"
#include "fit/errors/gain_error.h"
#include "fit/errors/guesses.h"
#include "fit/errors/rival_error.h"
#include "fit/estimate/kalman_gain.h"
#include "fit/estimate/other_gains.h"
#include "fit/search/rival_models.h"

namespace axisfit {
namespace {

SignalErrors errors_of(const Job& job, const ResidualSeries& series) {
  const Measurement& m = job.recordings[series.recording].measurements[series.measurement];
  const auto [low, high] = std::ranges::minmax(m.values);
  SignalErrors errors;
  errors.reduced_chi_square = mean_square(series.values);
  errors.rmse = m.sigma * std::sqrt(errors.reduced_chi_square);
  errors.nrmse_percent = high > low ? 100.0 * errors.rmse / (high - low) : 0.0;
  return errors;
}

std::vector<SignalScore> score_signals(const Job& job, const FitResult& fit) {
  std::vector<SignalScore> scores;
  const auto add = [&](const FitResult& result, std::optional<SignalErrors> SignalScore::*part) {
    for (const ResidualSeries& s : residual_series(job, result)) {
      SignalScore* score = find_series(scores, s);
      if (score == nullptr) score = &scores.emplace_back(SignalScore{s, {}, {}});
      score->*part = errors_of(job, s);
    }
  };
  if (std::ranges::none_of(fit.recordings,
                           [](const RecordingResult& r) { return r.tracking.has_value(); })) {
    add(fit, &SignalScore::free_running);
    return scores;
  }
  add(fit, &SignalScore::tracking);
  FitResult free = fit;
  for (RecordingResult& r : free.recordings) r.tracking.reset();
  add(free, &SignalScore::free_running);
  return scores;
}

/// The places in Job::free of the parameters that are to be profiled.
std::vector<std::size_t> parameters_to_profile(const Job& job, const RunOptions& options) {
  std::vector<std::size_t> chosen;
  const auto add = [&](std::size_t place) {
    if (std::ranges::find(chosen, place) == chosen.end()) chosen.push_back(place);
  };
  for (const ParameterId& id : options.profiles) {
    const auto at = std::ranges::find(job.free, id, &FreeParameter::id);
    if (at == job.free.end()) throw std::invalid_argument("a parameter to be profiled is not free");
    add(static_cast<std::size_t>(at - job.free.begin()));
  }
  for (std::size_t i = 0; i < job.free.size() && options.profile_all; ++i) add(i);
  return chosen;
}

/// Whether every recording has the same signals to be fitted.
bool records_alike(const std::vector<Recording>& recordings) {
  const auto signals_of = [](const Recording& r) {
    std::set<Signal> signals;
    for (const Measurement& m : r.measurements)
      if (m.fitted) signals.insert(m.signal);
    return signals;
  };
  const std::set<Signal> wanted = signals_of(recordings.front());
  return std::ranges::all_of(recordings,
                             [&](const Recording& r) { return signals_of(r) == wanted; });
}

/// Closes the loop. The recordings to validate may show what those to fit do not, such as friction
/// at places that these never reach. So where no effect passes, the loop is closed once more with
/// the roles exchanged: again what was not fitted decides. Who tries twice finds more by chance, so
/// more is asked for.
void close_loop(RunResult& result, const RunContext& context) {
  constexpr double kLeastShareOfSecond = 70.0;
  result.selection = select_effects(result.baseline, result.first, {}, context);
  if (result.selection->verdict.kind != SelectionVerdict::Kind::none_passes ||
      result.selection->interrupted || !records_alike(result.baseline.recordings))
    return;
  std::optional<Job> exchanged = with_exchanged_roles(result.baseline);
  if (!exchanged) return;
  context.report({.phase = "fitting with the roles exchanged"});
  FitResult first = estimate_with_noise(*exchanged, context);
  if (first.interrupted) throw Interrupted();
  const InverseStart inverse_start = try_inverse_start(*exchanged, first, context);
  if (!first.usable) return;
  EffectSelection found =
      select_effects(*exchanged, first, {.least_share = kLeastShareOfSecond}, context);
  if (found.interrupted) throw Interrupted();
  if (found.verdict.kind != SelectionVerdict::Kind::effects_accepted) return;
  result.roles_exchanged = true;
  result.baseline = *std::move(exchanged);
  result.first = std::move(first);
  result.inverse_start = inverse_start;
  result.selection = std::move(found);
}

/// All that follows the first fit.
void run_requested_analyses(RunResult& result, const RunContext& context) {
  const RunOptions& options = result.options;
  const auto report_progress = [&](const std::string& phase) {
    context.report({phase, 0, 0, result.fit().reduced_chi_square});
  };
  if (options.select_effects && result.first.usable) close_loop(result, context);
  if (result.selection && result.selection->horizon) result.horizon = result.selection->horizon;
  if (result.selection && result.selection->interrupted) throw Interrupted();
  if (result.selection && has_noise_from(result.baseline, NoiseSource::fit) &&
      !result.selection->effects.empty())
    result.selection->result.fit = estimate_with_noise(result.selection->result.job, context);
  if (!result.fit().recordings.empty()) {
    report_progress("analysing the residual");
    result.diagnosis = diagnose(result.job(), result.fit());
    // A loop has put them to the test.
    if (!result.selection && !result.diagnosis->explained)
      result.diagnosis->suspected_effects =
          suspected_effects(result.job(), result.fit(), context.quiet());
    // Where nothing can be simulated there is nothing to tell.
    if (result.diagnosis->tests.empty() &&
        std::ranges::none_of(result.diagnosis->forces, &MissingForce::found))
      result.diagnosis.reset();
  }
  if (const auto chosen = parameters_to_profile(result.job(), options);
      result.fit().usable && !chosen.empty())
    result.profiles = profiles(result.job(), result.fit(), chosen, context);
  // A motion that is simulated with a wrong model could wreck the machine.
  const bool safe = grade_of(result.job(), result.fit(), result.diagnosis).is_usable() &&
                    !held_by_bound(result.job(), result.fit());
  if (result.selection)
    for (const UndecidedPair& rivals : result.selection->rivals) {
      report_progress("discriminating between " + rivals.chosen + " and " + rivals.rival);
      result.discriminations.push_back(
          discriminate(*result.selection, rivals, safe, context.quiet()));
    }
  if (safe && options.suggest_experiment)
    result.suggestion = suggest_experiment(result.job(), result.fit(), context);
}

void predict(RunResult& result, const RunContext& context) {
  const ThreadPool pool(result.job().options.threads);
  try {
    result.predictions =
        predict_recordings(result.job(), result.fit(), *result.uncertainty, context);
    if (result.options.motion)
      result.motion =
          predict_motion(result.job(), result.fit(), *result.uncertainty, *result.options.motion);
  } catch (const Interrupted&) {
    result.interrupted = true;
  } catch (const std::runtime_error& problem) {
    result.no_prediction = problem.what();
  }
}

std::vector<MissingForce> missing_forces(const Job& job, const FitResult& fit) {
  std::vector<MissingForce> forces;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    forces.push_back(missing_force(job, fit, r));
  return forces;
}

FitGrade judge(const RunResult& result) {
  FitGrade grade = grade_of(result.job(), result.fit(), result.diagnosis);
  // Something is missing, though it cannot be told what.
  if (grade.grade == Grade::explained && result.selection &&
      (!result.selection->verdict.undecided.empty() ||
       result.selection->verdict.kind == SelectionVerdict::Kind::none_passes))
    grade = {.grade = Grade::usable, .reason = FitGrade::Reason::residual};
  return grade;
}

void collect_gain_errors(const Job& job, FitResult& fit, const RunContext& context) {
  const std::vector<FitResult> others = fits_at_other_gains(job, fit, context);
  fit.better_gain = better_gain(job, fit, others);
  std::vector<EstimatesAtGain> estimates;
  for (const FitResult& other : others)
    estimates.push_back({other.observer_gain, other.parameters});
  const auto shifts = gain_errors(fit.parameters, estimates);
  for (std::size_t i = 0; i < shifts.size(); ++i) fit.parameters[i].budget.gain = shifts[i];
}

std::optional<Scatter> collect_scatter(const Job& job, FitResult& fit) {
  std::optional<Scatter> scatter = scatter_of(job, fit.parameters, fit.observer_gain);
  if (scatter)
    for (const ParameterScatter& p : scatter->parameters)
      fit.parameters[p.parameter].budget.scatter = p.error;
  return scatter;
}

void collect_rival_errors(EffectSelection& selection) {
  auto& [added, job, fit] = selection.result;
  const auto shifts = rival_errors(job, fit.parameters, rival_models(selection));
  for (std::size_t i = 0; i < shifts.size(); ++i) fit.parameters[i].budget.rival = shifts[i];
}

/// Completes the error budgets of the final model, as far as it is worth it.
void collect_errors(RunResult& result, FitResult& last, const RunContext& context) {
  if (result.interrupted) return;
  context.report({.phase = "does the observer gain matter?"});
  try {
    collect_gain_errors(result.job(), last, context);
    if (!result.horizon) last.quiet_gain = quiet_gain(result.job(), last);
  } catch (const Interrupted&) {
    result.interrupted = true;
    return;
  }
  if (!result.grade.is_usable()) return;
  result.scatter = collect_scatter(result.job(), last);
  if (result.selection) collect_rival_errors(*result.selection);
}

void combine_errors(const Job& job, FitResult& fit) {
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    ParameterResult& p = fit.parameters[i];
    p.uncertainty = combined(p.budget, p.value, job.free[i]);
  }
}

/// Of a wrong model no error means anything.
void withdraw_errors(FitResult& fit) {
  for (ParameterResult& p : fit.parameters)
    p.uncertainty = {.of_wrong_model = true, .inflation = p.uncertainty.inflation};
}

/// The declared model and those of the loop, and the others. Of the last of them the result has
/// what is not known.
std::optional<Comparison> compare(const RunResult& result, const RunContext& context) {
  const ThreadPool pool(result.baseline.options.threads);
  std::vector<ModelEntry> models;
  if (result.selection)
    for (std::size_t i = 0; i + 1 < result.selection->models.size(); ++i) {
      const auto& [added, job, fit] = result.selection->models[i];
      ModelEntry& entry = models.emplace_back(ModelEntry{added, job, fit});
      entry.forces = result.scores[i].forces;
      if (!fit.usable) continue;
      const std::optional<Scatter> scatter = collect_scatter(job, entry.fit);
      combine_errors(job, entry.fit);
      entry.uncertainty = axis_uncertainty(job, entry.fit, scatter, entry.forces);
    }
  models.push_back(
      {result.selection ? result.selection->models.back().added : "", result.job(), result.fit(),
       result.uncertainty,
       result.diagnosis ? result.diagnosis->forces : missing_forces(result.job(), result.fit())});
  for (const OtherModel& other : result.options.others) {
    ModelEntry entry{other.name, with_model(result.baseline, other.model), {}, other.uncertainty};
    entry.fit = evaluated(entry.job);
    entry.forces = missing_forces(entry.job, entry.fit);
    models.push_back(std::move(entry));
  }
  return compare_models(models, context);
}

/// Gives the effects that are in the model the estimates of its last fit. When they were tried, the
/// simulation may have tracked the recordings, and other effects were missing.
void take_final_estimates(EffectSelection& selection) {
  for (EffectTrial& trial : selection.effects)
    if (trial.in_model)
      for (ParameterResult& p : trial.parameters) {
        const auto& last = selection.result.fit.parameters;
        if (const auto found = std::ranges::find(last, p.id, &ParameterResult::id);
            found != last.end())
          p = *found;
      }
}

void find_guess_influences(const Job& job, FitResult& fit) {
  if (job.guessed.empty() || !fit.usable) return;
  std::vector<std::vector<GuessInfluence>> found =
      guess_influences(job, fit.parameters, fit.observer_gain);
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    fit.parameters[i].rests_on = std::move(found[i]);
}

}  // namespace

RunResult run(Job job, const RunOptions& options, const RunContext& context) {
  validate(job);
  const auto begin = std::chrono::steady_clock::now();
  RunResult result;
  result.baseline = std::move(job);
  result.options = options;
  parameters_to_profile(result.baseline, options);  // fails before the fit
  if (result.baseline.choose_criterion) {
    result.horizon = choose_horizon(result.baseline, context);
    result.baseline.options.criterion = result.horizon->best().criterion;
  }
  result.first = estimate_with_noise(result.baseline, context);
  result.interrupted = result.first.interrupted;
  try {
    if (!result.interrupted) {
      result.inverse_start = try_inverse_start(result.baseline, result.first, context);
      run_requested_analyses(result, context);
    }
  } catch (const Interrupted&) {
    result.interrupted = true;
  }
  result.checks = check_recordings(result.baseline);
  if (result.selection)
    for (const SelectionStep& model : result.selection->models)
      result.scores.push_back(
          {score_signals(model.job, model.fit), missing_forces(model.job, model.fit)});
  FitResult& last = result.selection ? result.selection->result.fit : result.first;
  result.grade = judge(result);
  collect_errors(result, last, context);
  combine_errors(result.job(), last);
  if (result.grade.grade == Grade::model_wrong) withdraw_errors(last);
  if (result.grade.is_usable() && !result.interrupted) {
    result.uncertainty =
        axis_uncertainty(result.job(), last, result.scatter,
                         result.diagnosis ? std::span<const MissingForce>(result.diagnosis->forces)
                                          : std::span<const MissingForce>());
    if (options.predict) predict(result, context);
  }
  if (options.compare && !result.interrupted && !result.fit().recordings.empty()) {
    try {
      result.comparison = compare(result, context);
    } catch (const Interrupted&) {
      result.interrupted = true;
    }
  }
  result.second_opinion = second_opinion(result.job(), last);
  find_guess_influences(result.baseline, result.first);
  if (result.selection) {
    for (SelectionStep& model : result.selection->models)
      find_guess_influences(model.job, model.fit);
    find_guess_influences(result.job(), last);
    take_final_estimates(*result.selection);
  }
  const std::chrono::duration<double> wall_time = std::chrono::steady_clock::now() - begin;
  result.wall_time = wall_time.count();
  return result;
}

bool has_noise_from(const Job& job, NoiseSource source) {
  return std::ranges::any_of(job.recordings, [&](const Recording& r) {
    return std::ranges::find(r.measurements, source, &Measurement::noise) != r.measurements.end();
  });
}

const Experiment* next_experiment(const RunResult& result) {
  if (!result.options.suggest_experiment) return nullptr;
  for (const Discrimination& s : result.discriminations)
    if (s.experiment) return &*s.experiment;
  return result.suggestion ? &result.suggestion->experiment : nullptr;
}

std::optional<ExcludedSamples> excluded_samples(const Measurement& measurement) {
  ExcludedSamples excluded;
  for (std::size_t i = 0; i < measurement.excluded.size(); ++i) {
    if (!measurement.excluded[i]) continue;
    ++excluded.samples;
    excluded.mean += measurement.values[i];
  }
  if (excluded.samples == 0) return std::nullopt;
  const double n = static_cast<double>(excluded.samples);
  excluded.mean /= n;
  excluded.is_within_noise = std::abs(excluded.mean) < 4.0 * measurement.sigma / std::sqrt(n);
  return excluded;
}

const FreeParameter& as_specified(const RunResult& run_result, std::size_t parameter) {
  const std::vector<FreeParameter>& declared = run_result.baseline.free;
  return parameter < declared.size() ? declared[parameter] : run_result.job().free[parameter];
}

}  // namespace axisfit
