#include "fit/judge/model_score.h"

#include <algorithm>
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

}  // namespace

ModelScore score_of(const Job& job, const FitResult& fit) {
  return {score_signals(job, fit), missing_forces(job, fit)};
}

}  // namespace axisfit
