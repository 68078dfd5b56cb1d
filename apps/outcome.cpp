#include "apps/outcome.h"

#include <algorithm>
#include <chrono>
#include <cmath>

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
      auto score = std::ranges::find_if(scores, [&](const SignalScore& known) {
        return known.recording == s.recording && known.measurement == s.measurement &&
               known.fitted == s.fitted;
      });
      if (score == scores.end())
        score = scores.insert(scores.end(), {s.recording, s.measurement, s.fitted, {}, {}});
      (*score).*part = errors_of(job, s);
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

}  // namespace

Outcome find_outcome(JobFile file, bool close_the_loop,
                     const std::function<void(const Progress&)>& fitting,
                     const LoopProgress& closing) {
  const auto begin = std::chrono::steady_clock::now();
  Outcome outcome;
  outcome.file = std::move(file);
  outcome.first = estimate(outcome.file.job, fitting);
  if (close_the_loop && outcome.first.usable)
    outcome.loop = close_loop(outcome.file.job, outcome.first, {}, closing);
  if (outcome.fit().usable) {
    if (closing) closing("looking at the residual", 0, 0);
    outcome.diagnosis = diagnose(outcome.job(), outcome.fit());
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

}  // namespace axisfit
