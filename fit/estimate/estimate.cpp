#include "fit/estimate/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "fit/criterion/gains.h"
#include "fit/data/noise.h"
#include "fit/errors/input_noise.h"
#include "fit/estimate/continuation.h"
#include "fit/estimate/recipes.h"
#include "fit/solve/parameters.h"
#include "fit/solve/residual.h"

namespace axisfit {
namespace {

struct StartRun {
  std::vector<double> from;
  bool interrupted = false;
  ContinuationResult result;
};

/// Where the only start of a fit is.
Progress progress_of(const Stage& stage) {
  return {.phase = stage.observer_gain > 0.0
                       ? fmt::format("fitting, observer gain {:.3g} 1/s", stage.observer_gain)
                       : "fitting, free-running",
          .best = stage.reduced_cost};
}

/// All starts, spread over threads; every one is independent of the others. The first is at `from`,
/// or if that is empty as draw_start() says.
std::vector<StartRun> run_starts(const Job& job, const ParameterSpace& space,
                                 const RunContext& context, std::span<const double> from) {
  const int starts = std::max(1, job.options.starts);
  std::vector<StartRun> trials(static_cast<std::size_t>(starts));
  std::mutex mutex;
  Progress all{.phase = "starts", .of = starts};
  const ProgressReport& progress = context.progress;
  if (progress && starts > 1) progress(all);
  parallel_for(trials.size(), [&](std::size_t i) {
    StartRun& trial = trials[i];
    trial.interrupted = is_set(context.stop);
    if (trial.interrupted) return;  // a million starts would take their time to throw
    trial.from = i == 0 && !from.empty() ? std::vector(from.begin(), from.end())
                                         : draw_start(job, static_cast<int>(i));
    try {
      trial.result = run_continuation(
          job, space, space.internal(trial.from),
          [&](const Stage& stage) {
            if (progress && starts == 1) progress(progress_of(stage));
          },
          context);
    } catch (const Interrupted&) {
      trial.interrupted = true;
      return;
    }
    if (starts > 1) trial.result.last.at_solution.reset();  // large, and only the best needs it
    const std::lock_guard lock(mutex);
    ++all.done;
    if (trial.result.last.usable) all.best = std::fmin(all.best, trial.result.last.reduced_cost);
    if (progress && starts > 1) progress(all);
  });
  return trials;
}

double mean_square_error(const Measurement& measured, const std::vector<double>& simulated,
                         std::size_t first) {
  double sum = 0.0;
  std::size_t n = 0;
  for (std::size_t i = first; i < simulated.size(); ++i) {
    if (!measured.counts(i)) continue;
    sum += (measured.values[i] - simulated[i]) * (measured.values[i] - simulated[i]);
    ++n;
  }
  return n > 0 ? sum / static_cast<double>(n) : 0.0;
}

RecordingResult evaluate_recording(const Job& job, const ParameterSpace& space, std::size_t index,
                                   const Eigen::VectorXd& u, double observer_gain) {
  const Recording& recording = job.recordings[index];
  RecordingResult result;
  result.free_running = simulate_freely(job, space, index, u.data());
  const Observer observer = observer_for(recording, observer_gain);
  if (observer.active())
    result.tracking = simulate_recording(job, space, index, u.data(), observer);
  else
    result.tracking = simulate_in_windows(job, space, index, u.data());
  const std::size_t first = recording.score_initial_samples ? 0 : recording.initial_samples;
  for (std::size_t m = 0; m < recording.measurements.size(); ++m) {
    const Measurement& measurement = recording.measurements[m];
    SignalError error;
    error.signal = measurement.signal;
    error.fitted = measurement.fitted && recording.role == Role::fit;
    error.sigma = measurement.sigma;
    error.noise = measurement.noise;
    if (result.free_running.finished) {
      const double mean_square =
          mean_square_error(measurement, result.free_running.simulated[m], first);
      const auto [low, high] = std::ranges::minmax(measurement.values);
      error.rmse = std::sqrt(mean_square);
      const double percent = 100.0 * error.rmse / (high - low);
      error.nrmse_percent = std::isfinite(percent) ? percent : 0.0;
      error.reduced_chi_square = mean_square / (measurement.sigma * measurement.sigma);
    }
    if (result.tracking && result.tracking->finished) {
      const double mean_square =
          mean_square_error(measurement, result.tracking->simulated[m], first);
      error.prediction_rmse = std::sqrt(mean_square);
      error.prediction_reduced_chi_square = mean_square / (measurement.sigma * measurement.sigma);
    }
    result.signals.push_back(error);
  }
  return result;
}

/// Whether a constant would follow a fitted signal as well as the model does: then there is no fit.
bool is_not_followed(const Job& job, const FitResult& result, std::size_t recording,
                     std::size_t measurement) {
  const SignalError& e = result.recordings[recording].signals[measurement];
  if (!e.fitted) return false;
  if (!e.prediction_rmse && !result.recordings[recording].free_running.finished) return true;
  const double rmse = e.prediction_rmse.value_or(e.rmse);
  const double chi_square = e.prediction_reduced_chi_square.value_or(e.reduced_chi_square);
  // Small beside the noise, if that is not itself taken from the residual.
  const bool noisy = chi_square <= 2.0 && e.noise != NoiseSource::fit;
  return !noisy &&
         rmse > standard_deviation(job.recordings[recording].measurements[measurement].values);
}

/// Whether the model explains everything is for the test of the residuals to decide.
FitVerdict verdict_of(const Job& job, const FitResult& result, const SolveResult& solved) {
  using enum FitVerdict::Kind;
  if (!solved.usable) return {.kind = not_simulated};
  if (!solved.converged) return {.kind = no_minimum, .iteration_limit = job.options.max_iterations};
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    for (std::size_t m = 0; m < result.recordings[r].signals.size(); ++m)
      if (is_not_followed(job, result, r, m))
        return {.kind = signal_not_followed,
                .signal = result.recordings[r].signals[m].signal,
                .recording = r};
  FitVerdict verdict{.kind = usable};
  for (const ParameterResult& p : result.parameters)
    if (!p.uncertainty.determined && !p.uncertainty.at_bound) verdict.undetermined.push_back(p.id);
  return verdict;
}

}  // namespace

double reduced_cost(const FitResult& result) {
  double least = std::numeric_limits<double>::infinity();
  for (const StartResult& start : result.starts)
    if (start.usable) least = std::min(least, start.reduced_cost);
  return least;
}

std::vector<double> draw_start(const Job& job, int start) {
  std::seed_seq seeds{job.options.seed & 0xffffffffu, job.options.seed >> 32,
                      static_cast<std::uint64_t>(start)};
  std::mt19937_64 generator(seeds);
  std::vector<double> values;
  for (const FreeParameter& p : job.free) {
    const double z = 2.0 * uniform(generator) - 1.0;
    double value = p.initial;
    if (start > 0) {
      if (p.scale != Scale::linear)
        value *= std::pow(job.options.spread, z);
      else  // one that begins at zero stays there: it has no size to draw from
        value += z * job.options.spread * std::abs(p.initial);
    }
    values.push_back(std::clamp(value, p.lower, p.upper));
  }
  return values;
}

FitResult estimate(const Job& job, const RunContext& context, std::span<const double> from) {
  const ThreadPool pool(job.options.threads);
  const ParameterSpace space(job);
  std::vector<StartRun> trials = run_starts(job, space, context, from);
  const bool interrupted =
      std::erase_if(trials, [](const StartRun& t) { return t.interrupted; }) > 0;
  if (trials.empty()) throw Interrupted();
  const auto better = [](const StartRun& a, const StartRun& b) {
    if (a.result.last.usable != b.result.last.usable) return a.result.last.usable;
    return a.result.last.cost < b.result.last.cost;
  };
  const StartRun& best = *std::ranges::min_element(trials, better);
  const SolveResult& solved = best.result.last;

  FitResult result;
  result.interrupted = interrupted;
  for (const StartRun& trial : trials)
    result.starts.push_back({trial.from, space.values(trial.result.last.u),
                             trial.result.last.usable, trial.result.last.reduced_cost});
  result.message = solved.message;
  result.iterations = solved.iterations;
  result.stages = best.result.stages;
  result.observer_gain = final_gain(job);
  result.recordings.resize(job.recordings.size());
  parallel_for(job.recordings.size(), [&](std::size_t r) {
    result.recordings[r] = evaluate_recording(job, space, r, solved.u, result.observer_gain);
  });

  Linearization at_solution = linearize(job, space, solved, result.observer_gain);
  at_solution.input_noise = input_noise(job, space, solved.u, result.observer_gain, at_solution);
  const double degrees_of_freedom =
      static_cast<double>(at_solution.residuals.size()) - static_cast<double>(space.size()) -
      (result.observer_gain > 0.0 ? 0.0 : static_cast<double>(window_states(job)));
  if (at_solution.finite && degrees_of_freedom > 0.0)
    result.reduced_chi_square = at_solution.residuals.squaredNorm() / degrees_of_freedom;
  Uncertainty found = uncertainty(space, solved.u, at_solution);
  const std::vector<double> values = space.values(solved.u);
  for (std::size_t i = 0; i < space.size(); ++i)
    result.parameters.push_back(
        {space[i].id(), values[i], found.parameters[i], std::move(found.budgets[i])});
  result.input_part = found.input_part;
  result.correlation = std::move(found.correlation);
  result.degrees_of_freedom = found.degrees_of_freedom;
  result.autocorrelation_time = found.autocorrelation_time;
  result.identifiability = identifiability(
      space, solved.u, at_solution,
      std::sqrt(found.autocorrelation_time * std::max(1.0, result.reduced_chi_square)));
  result.at_solution = std::make_shared<const Linearization>(std::move(at_solution));
  result.verdict = verdict_of(job, result, solved);
  return result;
}

FitResult evaluated(const Job& job) {
  const ParameterSpace space(job);
  const Eigen::VectorXd none(0);
  FitResult result;
  result.observer_gain = final_gain(job);
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    result.recordings.push_back(evaluate_recording(job, space, r, none, result.observer_gain));
  return result;
}

FitResult estimate_with_noise(Job& job, const RunContext& context, std::span<const double> from) {
  FitResult result = estimate(job, context, from);
  Job again = job;
  again.options = recipe::polish(job.options);
  constexpr int kTurns = 20;
  constexpr double kStays = 1e-4;
  for (int turn = 0; turn < kTurns && result.is_usable(); ++turn) {
    // Of every signal: its sum of squares and number of samples.
    std::map<Signal, std::pair<double, double>> sums;
    for (const SeriesRows& rows : result.at_solution->series) {
      const Measurement& m = again.recordings[rows.recording].measurements[rows.measurement];
      if (m.noise != NoiseSource::fit) continue;
      const auto r = result.at_solution->residuals.segment(rows.first, rows.count);
      sums[m.signal].first += r.squaredNorm() * m.sigma * m.sigma;
      sums[m.signal].second += static_cast<double>(rows.count);
    }
    if (sums.empty()) return result;
    const double n = static_cast<double>(result.at_solution->residuals.size());
    const double spent = n / std::max(1.0, n - static_cast<double>(job.free.size()));
    double change = 0.0;
    for (Recording& recording : again.recordings)
      for (Measurement& m : recording.measurements) {
        const auto sum = sums.find(m.signal);
        if (m.noise != NoiseSource::fit || sum == sums.end()) continue;
        const double sigma = std::sqrt(spent * sum->second.first / sum->second.second);
        if (!(sigma > 0.0)) continue;
        change = std::max(change, std::abs(std::log(sigma / m.sigma)));
        m.sigma = sigma;
      }
    if (change < kStays) break;
    set_initial_values(again, values_of(result));
    FitResult next;
    try {
      next = estimate(again, context);
    } catch (const Interrupted&) {
      result.interrupted = true;
      return result;  // of the job as it was given
    }
    next.starts = std::move(result.starts);
    next.stages = std::move(result.stages);
    result = std::move(next);
  }
  again.free = job.free;
  again.options = job.options;
  job = std::move(again);
  return result;
}

std::vector<Minimum> distinct_minima(std::vector<StartResult> starts) {
  std::erase_if(starts, [](const StartResult& s) { return !s.usable; });
  std::ranges::stable_sort(starts, {}, &StartResult::reduced_cost);
  constexpr double kSame = 1e-3;
  std::vector<Minimum> minima;
  for (StartResult& s : starts) {
    if (minima.empty() || s.reduced_cost > (1.0 + kSame) * minima.back().reduced_cost)
      minima.push_back({s.reduced_cost, 0, std::move(s.to)});
    ++minima.back().starts;
  }
  return minima;
}

std::vector<double> values_of(const FitResult& result) { return values_of(result.parameters); }

Model<double> fitted_model(const Job& job, const FitResult& result,
                           std::optional<std::size_t> recording) {
  Model<double> model = job.model;
  const std::vector<double*> member = members(model);
  for (std::size_t i = 0; i < job.free.size(); ++i)
    if (!job.free[i].recording || job.free[i].recording == recording)
      *member[job.free[i].quantity] = result.parameters[i].value;
  return model;
}

}  // namespace axisfit
