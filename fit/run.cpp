#include "fit/run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

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

/// The parameters that are to be profiled.
std::vector<std::size_t> parameters_to_profile(const Job& job,
                                               const std::vector<std::string>& names) {
  const ParameterSpace space(job);
  std::vector<std::string> known;
  for (std::size_t i = 0; i < space.size(); ++i) known.push_back(space.name(i));
  std::vector<std::size_t> chosen;
  for (const std::string& name : names) {
    const auto at = std::ranges::find(known, name);
    if (at == known.end() && name != "all")
      throw std::runtime_error(
          fmt::format("--profile: {} is not a free parameter; free parameters are {}", name,
                      fmt::join(known, ", ")));
    for (std::size_t i = 0; i < space.size(); ++i)
      if ((name == "all" || name == known[i]) && std::ranges::find(chosen, i) == chosen.end())
        chosen.push_back(i);
  }
  return chosen;
}

/// All that follows the first fit.
void run_requested_analyses(RunResult& run_result, const ProgressReport& progress) {
  const auto report_progress = [&](const std::string& phase, int done = 0, int of = 0) {
    if (progress) progress({phase, done, of, run_result.fit().reduced_chi_square});
  };
  if (run_result.run_options.select_effects && run_result.first.usable)
    run_result.selection = select_effects(run_result.baseline, run_result.first, {}, progress);
  if (run_result.selection && run_result.selection->interrupted) throw Interrupted();
  if (run_result.selection && has_noise_from(run_result.baseline, NoiseSource::fit) &&
      !run_result.selection->effects.empty())
    run_result.selection->result.fit =
        estimate_with_noise(run_result.selection->result.job, progress);
  if (run_result.fit().usable) {
    report_progress("analysing the residual");
    run_result.diagnosis = diagnose(run_result.job(), run_result.fit());
  }
  if (run_result.fit().usable && !run_result.run_options.profiles.empty())
    run_result.profiles =
        profiles(run_result.job(), run_result.fit(),
                 parameters_to_profile(run_result.job(), run_result.run_options.profiles),
                 [&](int done, int of) { report_progress("profiles", done, of); });
  const ControllerSettings& controller = run_result.baseline.controller;
  if (run_result.selection)
    for (const UndecidedPair& rivals : run_result.selection->rivals) {
      report_progress("discriminating between " + rivals.chosen + " and " + rivals.rival + "");
      run_result.discriminations.push_back(
          discriminate(*run_result.selection, rivals, controller, run_result.baseline.limits));
    }
  if (run_result.run_options.experiment)
    run_result.suggestion = suggest_experiment(
        run_result.job(), run_result.fit(), controller, run_result.baseline.limits,
        [&](int done, int of) { report_progress("trying motions", done, of); });
}

}  // namespace

RunResult run(Job job, const RunOptions& run_options, const ProgressReport& progress) {
  const auto begin = std::chrono::steady_clock::now();
  RunResult run_result;
  run_result.baseline = std::move(job);
  run_result.run_options = run_options;
  run_result.baseline.options.stop = run_options.stop;
  parameters_to_profile(run_result.baseline, run_options.profiles);
  run_result.first = estimate_with_noise(run_result.baseline, progress);
  run_result.interrupted = run_result.first.interrupted;
  run_result.checks = check_recordings(run_result.baseline);
  try {
    if (!run_result.interrupted) run_requested_analyses(run_result, progress);
  } catch (const Interrupted&) {
    run_result.interrupted = true;
  }
  if (run_result.selection)
    for (const SelectionStep& model : run_result.selection->models) {
      ModelScore score{score_signals(model.job, model.fit), {}};
      for (std::size_t r = 0; r < model.job.recordings.size(); ++r)
        score.forces.push_back(missing_force(model.job, model.fit, r));
      run_result.scores.push_back(std::move(score));
    }
  const std::chrono::duration<double> wall_time = std::chrono::steady_clock::now() - begin;
  run_result.wall_time = wall_time.count();
  return run_result;
}

std::string stop_reason(const RunResult& run_result) {
  return run_result.time_limit_reached ? fmt::format(" by the time limit of {:g} s",
                                                     run_result.run_options.time_limit.value())
                                       : "";
}

bool has_noise_from(const Job& job, NoiseSource source) {
  return std::ranges::any_of(job.recordings, [&](const Recording& r) {
    return std::ranges::find(r.measurements, source, &Measurement::noise) != r.measurements.end();
  });
}

const Experiment* next_experiment(const RunResult& run_result) {
  if (!run_result.run_options.experiment) return nullptr;
  for (const Discrimination& s : run_result.discriminations)
    if (s.experiment) return &*s.experiment;
  return run_result.suggestion ? &run_result.suggestion->experiment : nullptr;
}

std::string overall_verdict(const RunResult& run_result) {
  const FitResult& fit = run_result.fit();
  if (!run_result.selection) return fit.verdict;
  // Both judge the same model by the same residual.
  return (fit.usable ? "Usable fit." : fit.verdict) + " " + run_result.selection->verdict;
}

std::optional<ExcludedSamples> excluded_samples(const Measurement& measurement) {
  ExcludedSamples excluded;
  for (std::size_t i = 0; i < measurement.values.size(); ++i) {
    if (measurement.counts(i)) continue;
    ++excluded.samples;
    excluded.mean += measurement.values[i];
  }
  if (excluded.samples == 0) return std::nullopt;
  const double n = static_cast<double>(excluded.samples);
  excluded.mean /= n;
  excluded.is_within_noise = std::abs(excluded.mean) < 4.0 * measurement.sigma / std::sqrt(n);
  return excluded;
}

std::string_view verdict_name(const ParameterUncertainty& uncertainty) {
  if (uncertainty.at_bound) return "at bound";
  if (!uncertainty.determined) return "not determined";
  return uncertainty.weak ? "weakly determined" : "determined";
}

const char* decision_name(Decision decision) {
  switch (decision) {
    case Decision::accepted:
      return "accepted";
    case Decision::undecided:
      return "undecided";
    case Decision::rejected:
      return "rejected";
  }
  return "";
}

const char* role_name(const Recording& recording, bool fitted) {
  if (recording.role == Role::validate) return "validate";
  return fitted ? "fit" : "held_out";
}

const char* role_name(const Recording& recording, const SignalError& signal) {
  if (recording.role == Role::validate) return "validate";
  return signal.fitted ? "fit" : "compare";
}

const FreeParameter& as_specified(const RunResult& run_result, std::size_t parameter) {
  const std::vector<FreeParameter>& declared = run_result.baseline.free;
  return parameter < declared.size() ? declared[parameter] : run_result.job().free[parameter];
}

}  // namespace axisfit
