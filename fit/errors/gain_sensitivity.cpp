#include "fit/errors/gain_sensitivity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "fit/estimate/quick_fit.h"
#include "fit/solve/parameters.h"

namespace axisfit {
namespace {

constexpr std::array kFactors{1.0 / 3.0, 3.0};

/// The fit at another gain, from where this one ended.
FitResult fit_at(Job job, const FitResult& fit, double gain, const RunContext& context) {
  set_initial_values(job, values_of(fit));
  job.options = quick_fit(job.options);
  job.options.observer_gain = gain;
  return estimate(job, context.quiet());
}

/// Mean square of the free-running errors on the recordings to validate, in the scatter of each
/// signal; none where there are no such recordings, or the simulation does not finish.
std::optional<double> free_running_error(const Job& job, const FitResult& fit) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    if (job.recordings[r].role != Role::validate) continue;
    if (!fit.recordings[r].free_running.finished) return std::nullopt;
    for (const SignalError& e : fit.recordings[r].signals) {
      sum += e.nrmse_percent * e.nrmse_percent;
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace

ParameterUncertainty widened(ParameterUncertainty known, double value, const FreeParameter& free,
                             double further_error) {
  if (!known.determined || known.at_bound || !(known.standard_error > 0.0)) return known;
  const double factor = std::hypot(1.0, further_error / known.standard_error);
  const auto moved = [&](double end) {
    const double wider =
        free.logarithmic ? value * std::pow(end / value, factor) : value + factor * (end - value);
    return std::clamp(wider, free.lower, free.upper);
  };
  if (known.has_interval()) {
    known.lower = moved(known.lower);
    known.upper = moved(known.upper);
  }
  known.standard_error *= factor;
  known.inflation *= factor;
  return known;
}

void allow_for_observer_gain(const Job& job, FitResult& fit, const RunContext& context) {
  if (job.options.observer != ObserverMode::fixed || !(fit.observer_gain > 0.0) || !fit.usable)
    return;
  const ThreadPool pool(job.options.threads);
  std::array<FitResult, kFactors.size()> others;
  parallel_for(others.size(), [&](std::size_t k) {
    others[k] = fit_at(job, fit, kFactors[k] * fit.observer_gain, context);
  });
  constexpr double kBetter = 0.8;  // of the error, not its square
  double least = kBetter * kBetter * free_running_error(job, fit).value_or(0.0);
  for (const FitResult& other : others) {
    if (!other.usable) continue;
    if (const auto error = free_running_error(job, other); error && *error < least) {
      least = *error;
      fit.better_gain = other.observer_gain;
    }
    for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
      ParameterResult& p = fit.parameters[i];
      const ParameterResult& there = other.parameters[i];
      if (!p.uncertainty.determined || !there.uncertainty.determined) continue;
      const double move = std::abs(there.value - p.value);
      const double errors =
          std::hypot(p.uncertainty.standard_error, there.uncertainty.standard_error);
      constexpr double kErrors = 2.0;
      if (move <= kErrors * errors ||
          (p.gain_shift && move <= std::abs(p.gain_shift->value - p.value)))
        continue;
      p.gain_shift = GainShift{other.observer_gain, there.value};
    }
  }
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    if (ParameterResult& p = fit.parameters[i]; p.gain_shift)
      p.uncertainty =
          widened(p.uncertainty, p.value, job.free[i], std::abs(p.gain_shift->value - p.value));
}

}  // namespace axisfit
