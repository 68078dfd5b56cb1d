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
                           [](const RecordingResult& r) { return r.held.has_value(); })) {
    add(fit, &SignalScore::free_running);
    return scores;
  }
  add(fit, &SignalScore::held);
  FitResult free = fit;
  for (RecordingResult& r : free.recordings) r.held.reset();
  add(free, &SignalScore::free_running);
  return scores;
}

/// The parameters that are to be profiled.
std::vector<std::size_t> profiled(const Job& job, const std::vector<std::string>& names) {
  const ParameterSpace space(job);
  std::vector<std::string> known;
  for (std::size_t i = 0; i < space.size(); ++i) known.push_back(space.name(i));
  std::vector<std::size_t> chosen;
  for (const std::string& name : names) {
    const auto at = std::ranges::find(known, name);
    if (at == known.end() && name != "all")
      throw std::runtime_error(
          fmt::format("--profile: {} is not fitted; fitted are {}", name, fmt::join(known, ", ")));
    for (std::size_t i = 0; i < space.size(); ++i)
      if ((name == "all" || name == known[i]) && std::ranges::find(chosen, i) == chosen.end())
        chosen.push_back(i);
  }
  return chosen;
}

/// All that follows the first fit.
void pursue(Outcome& outcome, const ProgressReport& progress) {
  const auto tell = [&](const std::string& phase, int done = 0, int of = 0) {
    if (progress) progress({phase, done, of, outcome.fit().reduced_chi_square});
  };
  if (outcome.wishes.close_loop && outcome.first.usable)
    outcome.loop = close_loop(outcome.baseline, outcome.first, {}, progress);
  if (outcome.loop && outcome.loop->interrupted) throw Interrupted();
  if (outcome.loop && has_noise_from(outcome.baseline, NoiseSource::fit) &&
      !outcome.loop->effects.empty())
    outcome.loop->result.fit = estimate_with_noise(outcome.loop->result.job, progress);
  if (outcome.fit().usable) {
    tell("looking at the residual");
    outcome.diagnosis = diagnose(outcome.job(), outcome.fit());
  }
  if (outcome.fit().usable && !outcome.wishes.profiles.empty())
    outcome.profiles =
        profiles(outcome.job(), outcome.fit(), profiled(outcome.job(), outcome.wishes.profiles),
                 [&](int done, int of) { tell("profiles", done, of); });
  const ControllerSettings& controller = outcome.baseline.controller;
  if (outcome.loop)
    for (const Rivals& rivals : outcome.loop->rivals) {
      tell("what tells " + rivals.chosen + " and " + rivals.rival + " apart?");
      outcome.separations.push_back(
          what_separates(*outcome.loop, rivals, controller, outcome.baseline.limits));
    }
  if (outcome.wishes.experiment)
    outcome.suggestion =
        suggest_experiment(outcome.job(), outcome.fit(), controller, outcome.baseline.limits,
                           [&](int done, int of) { tell("trying motions", done, of); });
}

}  // namespace

Outcome find_outcome(Job job, const Wishes& wishes, const ProgressReport& progress) {
  const auto begin = std::chrono::steady_clock::now();
  Outcome outcome;
  outcome.baseline = std::move(job);
  outcome.wishes = wishes;
  outcome.baseline.options.stop = wishes.stop;
  profiled(outcome.baseline, wishes.profiles);
  outcome.first = estimate_with_noise(outcome.baseline, progress);
  outcome.interrupted = outcome.first.interrupted;
  outcome.checks = check_recordings(outcome.baseline);
  try {
    if (!outcome.interrupted) pursue(outcome, progress);
  } catch (const Interrupted&) {
    outcome.interrupted = true;
  }
  if (outcome.loop)
    for (const LoopModel& model : outcome.loop->models) {
      ModelScore score{score_signals(model.job, model.fit), {}};
      for (std::size_t r = 0; r < model.job.recordings.size(); ++r)
        score.forces.push_back(missing_force(model.job, model.fit, r));
      outcome.scores.push_back(std::move(score));
    }
  const std::chrono::duration<double> wall_time = std::chrono::steady_clock::now() - begin;
  outcome.wall_time = wall_time.count();
  return outcome;
}

std::string stop_reason(const Outcome& outcome) {
  return outcome.out_of_time
             ? fmt::format(" by the time limit of {:g} s", outcome.wishes.time_limit.value())
             : "";
}

bool has_noise_from(const Job& job, NoiseSource source) {
  return std::ranges::any_of(job.recordings, [&](const Recording& r) {
    return std::ranges::find(r.measurements, source, &Measurement::noise) != r.measurements.end();
  });
}

const Experiment* next_experiment(const Outcome& outcome) {
  if (!outcome.wishes.experiment) return nullptr;
  for (const Separation& s : outcome.separations)
    if (s.experiment) return &*s.experiment;
  return outcome.suggestion ? &outcome.suggestion->experiment : nullptr;
}

std::string verdict_of(const Outcome& outcome) {
  const FitResult& fit = outcome.fit();
  if (!outcome.loop) return fit.verdict;
  // Both judge the same model by the same residual.
  return (fit.usable ? "Usable fit." : fit.verdict) + " " + outcome.loop->verdict;
}

std::optional<LeftOut> left_out(const Measurement& measurement) {
  LeftOut rest;
  for (std::size_t i = 0; i < measurement.values.size(); ++i) {
    if (measurement.counts(i)) continue;
    ++rest.samples;
    rest.mean += measurement.values[i];
  }
  if (rest.samples == 0) return std::nullopt;
  const double n = static_cast<double>(rest.samples);
  rest.mean /= n;
  rest.is_noise = std::abs(rest.mean) < 4.0 * measurement.sigma / std::sqrt(n);
  return rest;
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
    case Decision::refused:
      return "refused";
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

const FreeParameter& as_declared(const Outcome& outcome, std::size_t parameter) {
  const std::vector<FreeParameter>& declared = outcome.baseline.free;
  return parameter < declared.size() ? declared[parameter] : outcome.job().free[parameter];
}

}  // namespace axisfit
