#include "fit/run.h"

#include <algorithm>
#include <chrono>
#include <initializer_list>
#include <stdexcept>

#include "base/parallel.h"
#include "fit/data/recording_warnings.h"
#include "fit/data/validation.h"
#include "fit/errors/guesses.h"
#include "fit/errors/hold_shift.h"
#include "fit/errors/rival_error.h"
#include "fit/estimate/kalman_gain.h"
#include "fit/estimate/other_gains.h"
#include "fit/search/exchanged_roles.h"
#include "fit/search/rival_models.h"
#include "fit/search/suspects.h"

namespace axisfit {
namespace {

FitResult& final_fit(RunResult& result) {
  return result.selection ? result.selection->result.fit : result.first;
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

// The stages of a run, in order. Each adds to the result what it finds.

void choose_criterion(RunResult& result, const RunContext& context) {
  if (!result.baseline.choose_criterion) return;
  result.horizon = choose_horizon(result.baseline, context);
  result.baseline.options.criterion = result.horizon->best().criterion;
}

/// Before a search with two attempts alone: what the model lacks leaves no good end to others.
void fit_declared_model(RunResult& result, const RunContext& context) {
  Job job = result.baseline;
  if (result.options.select_effects) job.options.attempts = 2;
  result.first = estimate_with_noise(job, context);
  if (result.options.select_effects && !result.first.is_usable() && !result.first.interrupted)
    result.first = estimate_with_noise(result.baseline, context);
  result.interrupted = result.first.interrupted;
}

void fit_from_inverse_dynamics(RunResult& result, const RunContext& context) {
  result.inverse_start = try_inverse_start(result.baseline, result.first, context);
}

/// Where no effect passes, once more with the roles of the recordings exchanged.
void exchange_roles(RunResult& result, const RunContext& context) {
  if (result.selection->verdict.kind != SelectionVerdict::Kind::none_passes ||
      result.selection->interrupted || result.selection->cut_short)
    return;
  std::optional<ExchangedSearch> found = search_with_exchanged_roles(result.baseline, context);
  if (!found) return;
  if (found->selection.cut_short) {
    result.selection->cut_short = true;
    return;
  }
  result.roles_exchanged = true;
  result.baseline = std::move(found->baseline);
  result.first = std::move(found->first);
  result.inverse_start = found->inverse_start;
  result.selection = std::move(found->selection);
}

/// A search that ends far from the noise may have begun at a wrong end of the declared model.
void search_from_elsewhere(RunResult& result, const RunContext& context) {
  constexpr double kClearlyBetter = 0.9, kNear = 5.0;
  const EffectSelection& found = *result.selection;
  if (found.explained || found.interrupted || found.cut_short ||
      reduced_cost(found.result.fit) < kNear)
    return;
  FitResult other = estimate_with_noise(result.baseline, context);
  if (!other.is_usable() || (result.first.is_usable() &&
                             reduced_cost(other) > kClearlyBetter * reduced_cost(result.first)))
    return;
  result.first = std::move(other);
  result.selection = select_effects(result.baseline, result.first, {}, context);
}

void close_loop(RunResult& result, const RunContext& context) {
  if (!result.options.select_effects ||
      !(result.first.is_usable() || result.first.verdict.kind == FitVerdict::Kind::no_minimum))
    return;
  result.selection = select_effects(result.baseline, result.first, {}, context);
  search_from_elsewhere(result, context);
  // Not even while it tracks: there is nothing to begin with.
  if (!result.first.is_usable() && !result.selection->interrupted &&
      result.selection->verdict.kind == SelectionVerdict::Kind::no_usable_fit) {
    result.selection.reset();
    return;
  }
  exchange_roles(result, context);
  if (result.selection->horizon) result.horizon = result.selection->horizon;
  if (result.selection->interrupted) throw Interrupted();
  if (has_noise_from(result.baseline, NoiseSource::fit) && !result.selection->effects.empty())
    result.selection->result.fit = estimate_with_noise(result.selection->result.job, context);
}

void analyse_residual(RunResult& result, const RunContext& context) {
  const FitResult& fit = result.fit();
  if (fit.recordings.empty()) return;
  context.report(
      {.phase = "analysing the residual", .best = fit.reduced_chi_square, .work = Work::errors});
  Diagnosis diagnosis = diagnose(result.job(), fit);
  // Where nothing can be simulated there is nothing to tell.
  if (diagnosis.tests.empty() && std::ranges::none_of(diagnosis.forces, &MissingForce::found))
    return;
  // A search has tested them.
  if (!result.selection && !diagnosis.explained)
    result.suspects = suspected_effects(result.job(), fit, {.run = context.quiet()});
  result.diagnosis = std::move(diagnosis);
}

void find_profiles(RunResult& result, const RunContext& context) {
  const auto chosen = parameters_to_profile(result.job(), result.options);
  if (result.fit().is_usable() && !chosen.empty())
    result.profiles = profiles(result.job(), result.fit(), chosen, context);
}

void find_other_days(RunResult& result, const RunContext& context) {
  if (!result.diagnosis) return;
  context.report({.phase = "does a recording differ in a few parameters?", .work = Work::errors});
  result.other_days = other_days(result.job(), result.fit(), *result.diagnosis, {}, context);
}

/// Recordings of another day count with the parameters that differ there.
FitGrade grade_with_other_days(const RunResult& result) {
  if (result.other_days.empty()) return grade_of(result.job(), result.fit(), result.diagnosis);
  FitResult fit = result.fit();
  Diagnosis diagnosis = *result.diagnosis;
  for (const OtherDay& day : result.other_days) {
    fit.recordings[day.recording] = day.result;
    diagnosis.forces[day.recording] = day.force;
  }
  return grade_of(result.job(), fit, diagnosis);
}

/// A fit can follow one of two signals that contradict each other to its noise, and be wrong. Where
/// it follows neither, that is why.
void look_for_contradictions(RunResult& result) {
  using enum FitGrade::Reason;
  FitGrade& grade = result.grade;
  if (grade.grade > Grade::model_wrong || grade.reason == drift) return;
  const Job& job = result.baseline;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    for (const RecordingWarning& w : warnings_of(job, job.recordings[r], result.checks[r]))
      if (const auto* wrong = std::get_if<warning::WrongRate>(&w))
        grade = {.grade = std::max(grade.grade, Grade::usable),
                 .reason = contradiction,
                 .recording = r,
                 .signal = wrong->rate.rate,
                 .uses = grade.uses};
}

void judge(RunResult& result) {
  result.grade = grade_with_other_days(result);
  look_for_contradictions(result);
  // Something is missing, though it cannot be told what.
  if (result.grade.grade == Grade::explained && result.selection &&
      (!result.selection->verdict.undecided.empty() ||
       result.selection->verdict.kind == SelectionVerdict::Kind::none_passes))
    result.grade = {
        .grade = Grade::usable, .reason = FitGrade::Reason::residual, .uses = result.grade.uses};
}

void design_experiments(RunResult& result, const RunContext& context) {
  // A motion that is simulated with a wrong model could wreck the machine.
  const bool safe = result.grade.is_usable() && !held_by_bound(result.job(), result.fit());
  if (result.selection)
    for (const Substitution& rivals : result.selection->substitutions) {
      context.report({.phase = "discriminating between " + rivals.chosen + " and " + rivals.rival,
                      .best = result.fit().reduced_chi_square,
                      .work = Work::errors});
      result.discriminations.push_back(
          discriminate(*result.selection, rivals, safe, context.quiet()));
    }
  if (safe && result.options.suggest_experiment)
    result.suggestion = suggest_experiment(result.job(), result.fit(), context);
}

void score_models(RunResult& result) {
  if (!result.selection) return;
  for (const FittedModel& model : result.selection->models)
    result.scores.push_back(score_of(model.job, model.fit));
}

void find_gain_errors(RunResult& result, const RunContext& context) {
  context.report({.phase = "does the observer gain matter?", .work = Work::errors});
  const Job& job = result.job();
  FitResult& fit = final_fit(result);
  fit.better_gain = better_gain(job, fit, add_gain_errors(job, fit, context));
  if (!result.horizon) fit.quiet_gain = quiet_gain(job, fit);
}

void find_rival_errors(EffectSelection& selection) {
  auto& [added, job, fit] = selection.result;
  const auto shifts = rival_errors(job, fit.parameters, rival_models(selection));
  for (std::size_t i = 0; i < shifts.size(); ++i) fit.parameters[i].budget.rival = shifts[i];
}

/// What scatter and rivals add to the errors. Of a wrong model it would tell nothing.
void find_model_errors(RunResult& result, const RunContext&) {
  if (!result.grade.is_usable()) return;
  FitResult& fit = final_fit(result);
  result.scatter = add_scatter(result.job(), fit.parameters, fit.observer_gain);
  if (result.selection) find_rival_errors(*result.selection);
}

/// After a stop, what linear algebra tells, while the user waits: first scatter, which tells how
/// long that takes, too.
void find_errors_after_stop(RunResult& result) {
  constexpr double kWait = 0.6;  // s, altogether
  constexpr double kMore = 2.0;  // times as long for both gains
  if (!result.grade.is_usable()) return;
  FitResult& fit = final_fit(result);
  const auto begin = std::chrono::steady_clock::now();
  result.scatter = add_scatter(result.job(), fit.parameters, fit.observer_gain);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  const bool in_time = (1.0 + kMore) * taken.count() < kWait;
  if (in_time) add_linear_gain_errors(result.job(), fit);
  result.errors_known = in_time || !tracks(result.job().options.criterion)
                            ? ErrorsKnown::to_first_order
                            : ErrorsKnown::no;
  // A finished run might have found less.
  if (result.grade.grade == Grade::explained)
    result.grade = {
        .grade = Grade::usable, .reason = FitGrade::Reason::stopped, .uses = result.grade.uses};
}

void combine_errors(const Job& job, FitResult& fit) {
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    ParameterResult& p = fit.parameters[i];
    p.uncertainty = combined(p.budget, p.value, job.free[i]);
  }
}

void combine_errors(RunResult& result) {
  FitResult& fit = final_fit(result);
  combine_errors(result.job(), fit);
  if (result.errors_known == ErrorsKnown::no)
    for (ParameterResult& p : fit.parameters)
      p.uncertainty = {.error_not_known = true, .inflation = p.uncertainty.inflation};
  // The errors of a wrong model mean nothing.
  if (result.grade.grade == Grade::model_wrong)
    for (ParameterResult& p : fit.parameters)
      p.uncertainty = {.of_wrong_model = true, .inflation = p.uncertainty.inflation};
}

void predict(RunResult& result, const RunContext& context) {
  if (!result.grade.is_usable()) return;
  const Job& job = result.job();
  const FitResult& fit = result.fit();
  result.uncertainty =
      axis_uncertainty(job, fit, result.scatter,
                       result.diagnosis ? result.diagnosis->forces : std::vector<MissingForce>());
  if (!result.options.predict) return;
  const ThreadPool pool(job.options.threads);
  try {
    result.predictions = predict_recordings(job, fit, *result.uncertainty, context);
    if (result.options.motion)
      result.motion = predict_motion(job, fit, *result.uncertainty, *result.options.motion);
  } catch (const std::runtime_error& problem) {
    result.no_prediction = problem.what();
  }
}

/// Compares the baseline model, those of the search, and the others. The result has the uncertainty
/// of the final model already.
void compare(RunResult& result, const RunContext& context) {
  if (!result.options.compare || result.fit().recordings.empty()) return;
  const ThreadPool pool(result.baseline.options.threads);
  std::vector<ModelEntry> models;
  if (result.selection)
    for (std::size_t i = 0; i + 1 < result.selection->models.size(); ++i) {
      const auto& [added, job, fit] = result.selection->models[i];
      ModelEntry& entry = models.emplace_back(ModelEntry{added, job, fit});
      entry.forces = result.scores[i].forces;
      if (!fit.is_usable()) continue;
      const std::optional<Scatter> scatter =
          add_scatter(job, entry.fit.parameters, entry.fit.observer_gain);
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
  result.comparison = compare_models(models, context);
}

void find_guess_influences(const Job& job, FitResult& fit) {
  if (job.guessed.empty() || !fit.is_usable()) return;
  std::vector<std::vector<GuessInfluence>> found =
      guess_influences(job, fit.parameters, fit.observer_gain);
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    fit.parameters[i].rests_on = std::move(found[i]);
}

/// What is said of the final model's estimates alone.
void find_hold_shifts(const Job& job, FitResult& fit) {
  if (!fit.is_usable() || !fit.at_solution) return;
  const double excess = fit.autocorrelation_time * std::max(1.0, fit.reduced_chi_square);
  const auto found = hold_shifts(job, fit.parameters, *fit.at_solution, excess, fit.observer_gain);
  for (std::size_t i = 0; i < found.size(); ++i) fit.parameters[i].other_hold = found[i];
}

void find_guess_influences(RunResult& result) {
  find_guess_influences(result.baseline, result.first);
  if (!result.selection) return;
  for (FittedModel& model : result.selection->models) find_guess_influences(model.job, model.fit);
  find_guess_influences(result.job(), final_fit(result));
}

/// Gives the effects that are in the model the estimates of its last fit. When they were tried, the
/// simulation may have tracked the recordings, and other effects were missing.
void take_final_estimates(RunResult& result) {
  if (!result.selection) return;
  const std::vector<ParameterResult>& last = result.fit().parameters;
  for (Outcome& outcome : result.selection->effects) {
    if (!outcome.in_model) continue;
    for (ParameterResult& p : outcome.parameters)
      if (const auto found = std::ranges::find(last, p.id, &ParameterResult::id);
          found != last.end())
        p = *found;
  }
}

/// Runs one stage after another. A stop ends them, and what they found until then counts.
void run_stages(RunResult& result, const RunContext& context,
                std::initializer_list<void (*)(RunResult&, const RunContext&)> stages) {
  try {
    for (const auto stage : stages)
      if (!result.interrupted) stage(result, context);
  } catch (const Interrupted&) {
    result.interrupted = true;
  }
}

}  // namespace

RunResult run(Job job, const RunOptions& options, const RunContext& context) {
  validate(job);
  RunResult result;
  result.baseline = std::move(job);
  result.options = options;
  parameters_to_profile(result.baseline, options);  // fails before the fit
  WorkTimes watch;
  RunContext timed = context;
  timed.progress = [&](const Progress& now) {
    watch.enter(now.work);
    context.report(now);
  };
  choose_criterion(result, timed);
  fit_declared_model(result, timed);
  run_stages(
      result, timed,
      {fit_from_inverse_dynamics, close_loop, analyse_residual, find_profiles, find_other_days});
  watch.enter(Work::errors);
  result.checks = check_recordings(result.baseline);
  judge(result);
  run_stages(result, timed, {design_experiments, find_gain_errors, find_model_errors});
  if (result.interrupted) find_errors_after_stop(result);
  score_models(result);
  combine_errors(result);
  run_stages(result, timed, {predict, compare});
  result.second_opinion = second_opinion(result.job(), result.fit());
  find_guess_influences(result);
  find_hold_shifts(result.job(), final_fit(result));
  take_final_estimates(result);
  if (result.selection && result.selection->cut_short) result.interrupted = true;
  result.times = watch.times();
  for (const WorkTime& time : result.times) result.wall_time += time.wall;
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

const FreeParameter& as_specified(const RunResult& run_result, std::size_t parameter) {
  const std::vector<FreeParameter>& declared = run_result.baseline.free;
  return parameter < declared.size() ? declared[parameter] : run_result.job().free[parameter];
}

}  // namespace axisfit
