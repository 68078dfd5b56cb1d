#include "fit/design/experiment.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <random>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "base/random.h"
#include "fit/errors/input_noise.h"
#include "fit/judge/series.h"
#include "fit/solve/residual.h"
#include "fit/solve/solve.h"
#include "sim/controller.h"
#include "sim/sampling.h"
#include "sim/simulate.h"

namespace axisfit {
namespace {

const Recording& first_fitted(const Job& job) {
  return *std::ranges::find(job.recordings, Role::fit, &Recording::role);
}

/// Mean square of the residuals of a signal times samples per independent sample.
double excess_of(const std::vector<ResidualSeries>& residuals, const Job& job, Signal signal) {
  double excess = 1.0;
  for (const ResidualSeries& s : residuals)
    if (s.fitted && job.recordings[s.recording].measurements[s.measurement].signal == signal)
      excess = std::max(excess, mean_square(s.values) * autocorrelation_time(s.values));
  return excess;
}

/// The job with one more recording, of an experiment yet to be made; all others only to validate.
Job with_next(const Job& job, const std::vector<ResidualSeries>& residuals) {
  Job next = job;
  const Recording& like = first_fitted(job);
  Recording recording;
  recording.name = "next";
  recording.times = next_sampling_times(job);
  const std::size_t start = quantity_index("initial.y0");
  for (const auto& [quantity, value] : like.overrides)
    if (quantity == start) recording.overrides.emplace_back(quantity, value);
  for (const Measurement& m : like.measurements) {
    if (!m.fitted) continue;
    Measurement& measurement = recording.measurements.emplace_back();
    measurement.signal = m.signal;
    measurement.filter = m.filter;
    measurement.sigma =
        m.sigma * std::sqrt(excess_of(residuals, job, m.signal) * static_cast<double>(m.hold));
  }
  for (Recording& r : next.recordings) r.role = Role::validate;
  next.recordings.push_back(std::move(recording));
  return next;
}

bool is_feasible(const MachineLimits& limits, const SimulatedRecording& simulation) {
  return simulation.finished && std::ranges::all_of(simulation.samples, [&](const Sample& s) {
           return is_within(limits, s.position, s.velocity);
         });
}

/// Residuals and Jacobian of each experiment; not finite where it does not keep to the limits.
std::vector<Linearization> sensitivities_of(const std::vector<Experiment>& candidates,
                                            const Job& next, const FitResult& fit,
                                            const MachineLimits& limits,
                                            const RunContext& context) {
  const std::size_t added = next.recordings.size() - 1;
  const Model<double> model = fitted_model(next, fit);
  const ParameterSpace space(next);
  const Eigen::VectorXd u = space.internal(values_of(fit));
  const ThreadPool pool(next.options.threads);
  std::vector<Linearization> sensitivities(candidates.size());
  std::mutex mutex;
  int done = 0;
  parallel_for(candidates.size(), [&](std::size_t i) {
    context.check_stop();
    Job trial = next;
    Recording& recording = trial.recordings[added];
    recording.command = commands_of(candidates[i], model, recording.times);
    const SimulatedRecording simulation = simulate_recording(trial, space, added, u.data(), {});
    if (is_feasible(limits, simulation)) {
      for (std::size_t m = 0; m < recording.measurements.size(); ++m)
        recording.measurements[m].values = simulation.simulated[m];
      sensitivities[i] = linearize(trial, space, u, fit.observer_gain);
      sensitivities[i].residuals.setZero();  // of rounding, which has a colour
    }
    const std::lock_guard lock(mutex);
    context.report({.phase = "trying motions",
                    .done = ++done,
                    .of = static_cast<int>(candidates.size()),
                    .best = fit.reduced_chi_square,
                    .work = Work::errors});
  });
  return sensitivities;
}

/// Without those of priors.
Eigen::Index rows_of(const Linearization& linear) {
  return linear.series.empty() ? 0 : linear.series.back().first + linear.series.back().count;
}

/// Both, the rows of the first without its priors and with an exact input, before all others.
Linearization joined(const Linearization& first, const Linearization& second) {
  const Eigen::Index rows = rows_of(first);
  Linearization both;
  both.finite = true;
  both.series = first.series;
  for (SeriesRows series : second.series) {
    series.first += rows;
    both.series.push_back(series);
  }
  both.residuals.resize(rows + second.residuals.size());
  both.residuals << first.residuals.head(rows), second.residuals;
  both.jacobian.resize(both.residuals.size(), second.jacobian.cols());
  both.jacobian << first.jacobian.topRows(rows), second.jacobian;
  both.input_noise = second.input_noise;
  return both;
}

/// Standard errors, of u, from normal equations. An error of one carries no information.
Eigen::VectorXd errors_of(Eigen::MatrixXd normal) {
  normal.diagonal().array() += 1.0;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(normal.rows(), normal.cols());
  return LeastSquaresSolver(normal).solve(one).diagonal().cwiseSqrt();
}

/// The normal equations of a fit, every series worth what its residual says.
Eigen::MatrixXd normal_of(const Job& job, const Linearization& at,
                          const std::vector<ResidualSeries>& residuals) {
  Eigen::MatrixXd normal = at.jacobian.transpose() * at.jacobian;
  for (const SeriesRows& rows : at.series) {
    const Signal signal = job.recordings[rows.recording].measurements[rows.measurement].signal;
    const auto block = at.jacobian.middleRows(rows.first, rows.count);
    normal -= (1.0 - 1.0 / excess_of(residuals, job, signal)) * (block.transpose() * block);
  }
  return normal;
}

}  // namespace

MachineLimits complete_limits(const Job& job, const FitResult& fit) {
  MachineLimits limits = job.limits;
  double lowest = INFINITY, highest = -INFINITY, speed = 0.0, force = 0.0;
  for (const RecordingResult& r : fit.recordings)
    for (const Sample& s : r.free_running.samples) {
      lowest = std::min(lowest, s.position);
      highest = std::max(highest, s.position);
      speed = std::max(speed, std::abs(s.velocity));
      force = std::max(force, std::abs(s.drive_force));
    }
  if (!limits.lowest) limits.lowest = lowest;
  if (!limits.highest) limits.highest = highest;
  if (!limits.speed) limits.speed = speed;
  if (!limits.command)
    limits.command = capabilities(job.model.structure).is_force_driven
                         ? force / fitted_model(job, fit).axis.K_f
                         : job.model.controller.gains.limit;
  limits.command = std::min(*limits.command, job.model.controller.gains.limit);
  return limits;
}

bool is_within(const MachineLimits& limits, double position, double velocity) {
  // A motion may reach what a recording covered once.
  constexpr double kTouch = 1e-6;
  return position >= *limits.lowest - kTouch && position <= *limits.highest + kTouch &&
         std::abs(velocity) <= *limits.speed * (1.0 + kTouch);
}

std::vector<Experiment> candidate_motions(const Structure& structure, const MachineLimits& limits,
                                          double duration) {
  std::vector<Experiment> candidates;
  const auto add = [&](const Motion& motion) { candidates.push_back({motion, duration}); };
  constexpr std::array kShares{1.0, 0.5, 0.2, 0.1, 0.05};
  const auto shares = structure.closed_loop ? std::span<const double>() : std::span(kShares);
  for (const double share : shares)
    for (const double sign : {1.0, -1.0}) {
      const double u = sign * share * *limits.command;
      add(StepMotion{u, 0.0});
      for (const double part : {0.25, 0.125, 0.0625}) {
        const double hold = part * duration;
        add(LevelsMotion{{u, -u, 0.5 * u, -0.5 * u, 0.2 * u, -0.2 * u, 0.0}, hold});
        add(LevelsMotion{{u, 0.0, -u, 0.0}, hold});
      }
      for (const double f : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0}) add(SineMotion{u, f, f});
      for (const double f : {5.0, 20.0, 60.0}) add(SineMotion{u, 0.5, f});
      for (const double bit : {0.01, 0.025, 0.05, 0.1, 0.2}) add(PrbsMotion{u, bit, 0.0, 1});
    }
  if (!capabilities(structure).is_electric && !structure.closed_loop) return candidates;
  for (const double part : {0.9, 0.5, 0.2, -0.9, -0.5, -0.2})
    for (const double share : {0.9, 0.5, 0.2}) {
      const MoveMotion move{part * (*limits.highest - *limits.lowest), share * *limits.speed,
                            4.0 * share * *limits.speed};
      if (move.distance == 0.0 || move.speed == 0.0) continue;
      add(move);
    }
  return candidates;
}

Schedule commands_of(const Experiment& experiment, const Model<double>& model,
                     std::span<const double> times) {
  const double period = model.controller.timing.period;
  const auto* move = std::get_if<MoveMotion>(&experiment.motion);
  if (move == nullptr) return schedule_of(experiment.motion, experiment.duration, period);
  if (whole_periods(model.controller.timing, model.axis.T_d).first > kMostPeriodsLate) return {};
  return simulate_move(model, reference_of(*move), times,
                       [](std::size_t, const Integrator<double>&) {});
}

std::vector<double> next_sampling_times(const Job& job) {
  const std::vector<double>& like = first_fitted(job).times;
  constexpr double kMaxDuration = 10.0;  // s; longer motions repeat themselves
  const double interval = mean_interval(like);
  std::vector<double> times;
  for (std::size_t i = 0; i < like.size() && static_cast<double>(i) * interval <= kMaxDuration; ++i)
    times.push_back(static_cast<double>(i) * interval);
  return times;
}

std::optional<std::size_t> held_by_bound(const Job& job, const FitResult& fit) {
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const FreeParameter& free = job.free[i];
    const Quantity& quantity = job.entry(free.quantity).quantity;
    const double middle = 0.5 * (free.lower + free.upper);
    const bool is_range = fit.parameters[i].value > middle ? free.upper == quantity.upper
                                                           : free.lower == quantity.lower;
    if (fit.parameters[i].uncertainty.at_bound && !is_range) return i;
  }
  return std::nullopt;
}

std::optional<Reach> reach_of(const Experiment& experiment, const Job& job, const FitResult& fit,
                              const MachineLimits& limits) {
  Job next = with_next(job, {});
  const std::size_t added = next.recordings.size() - 1;
  const std::vector<double>& times = next.recordings[added].times;
  const ParameterSpace space(next);
  Eigen::VectorXd u = space.internal(values_of(fit));
  constexpr std::size_t kEnumerated = 5;
  constexpr std::uint64_t kCorners = 1 << kEnumerated;
  std::mt19937_64 generator(1);
  Reach reach{INFINITY, -INFINITY, 0.0};
  for (std::uint64_t corner = 0; corner <= kCorners; ++corner) {
    for (std::size_t i = 0; i < space.size() && corner > 0; ++i) {
      const ParameterUncertainty& known = fit.parameters[i].uncertainty;
      const bool up =
          space.size() <= kEnumerated ? (corner >> i & 1) != 0 : uniform(generator) < 0.5;
      const double end = known.has_interval() ? (up ? known.upper : known.lower)
                                              : (up ? space[i].upper : space[i].lower);
      u[static_cast<Eigen::Index>(i)] = space.internal(i, end);
    }
    const Model<double> model = model_at(next, space, u.data(), added);
    bool within = true;
    const auto read = [&](std::size_t, const Integrator<double>& axis) {
      const double position = axis.state()[0], velocity = axis.state()[1];
      within = within && is_within(limits, position, velocity);
      reach.lowest = std::min(reach.lowest, position);
      reach.highest = std::max(reach.highest, position);
      reach.speed = std::max(reach.speed, std::abs(velocity));
    };
    // A fit rejects parameters with which the gear chatters; the arm hardly moves meanwhile.
    const SimulationResult simulation =
        simulate(model, commands_of(experiment, model, times), times, read);
    if (!simulation.finished || !within) return std::nullopt;
  }
  return reach;
}

std::optional<Suggestion> suggest_experiment(const Job& job, const FitResult& fit,
                                             const RunContext& context) {
  if (!fit.is_usable() || job.free.empty() || held_by_bound(job, fit)) return std::nullopt;
  Suggestion suggestion;
  suggestion.limits = complete_limits(job, fit);
  const std::vector<ResidualSeries> residuals = residual_series(job, fit);
  const Job next = with_next(job, residuals);
  const std::vector<Experiment> candidates = candidate_motions(
      job.model.structure, suggestion.limits, next.recordings.back().times.back());
  const std::vector<Linearization> sensitivities =
      sensitivities_of(candidates, next, fit, suggestion.limits, context);

  const auto worst_of = [&](const Eigen::VectorXd& errors) {
    std::pair<std::size_t, double> worst{0, -1.0};
    for (std::size_t i = 0; i < job.free.size(); ++i) {
      const double error = errors[static_cast<Eigen::Index>(i)];
      // A parameter at its bound counts as known.
      if (!fit.parameters[i].uncertainty.at_bound && error > worst.second) worst = {i, error};
    }
    return worst;
  };
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(values_of(fit));
  Linearization at_solution = linearize(job, space, u, fit.observer_gain);
  at_solution.input_noise = input_noise(job, space, u, fit.observer_gain, at_solution);
  const Eigen::MatrixXd normal = normal_of(job, at_solution, residuals);
  suggestion.parameter = worst_of(errors_of(normal)).first;
  std::vector<double> worst(candidates.size(), INFINITY);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!sensitivities[i].finite) continue;
    ++suggestion.feasible;
    const auto rows = sensitivities[i].jacobian.topRows(rows_of(sensitivities[i]));
    worst[i] = worst_of(errors_of(normal + rows.transpose() * rows)).second;
  }
  suggestion.tried = static_cast<int>(candidates.size());
  // The best of those that are safe: most of the others fail at the first corner.
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return worst[i]; });
  const Linearization* best = nullptr;
  for (const std::size_t i : order) {
    if (!std::isfinite(worst[i])) break;
    context.check_stop();
    const auto reach = reach_of(candidates[i], job, fit, suggestion.limits);
    if (!reach) continue;
    best = &sensitivities[i];
    suggestion.experiment = candidates[i];
    suggestion.reach = *reach;
    break;
  }
  if (best == nullptr) return std::nullopt;

  // As the fit itself will judge.
  suggestion.predicted = uncertainty(space, u, joined(*best, at_solution));
  return suggestion;
}

}  // namespace axisfit
