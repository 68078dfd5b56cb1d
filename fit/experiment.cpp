#include "fit/experiment.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <mutex>

#include "fit/parallel.h"
#include "fit/residuals/series.h"

namespace axisfit {
namespace {

const Recording& first_fitted(const Job& job) {
  return *std::ranges::find(job.recordings, Role::fit, &Recording::role);
}

/// Limits in which what was not given is what the recordings covered.
MachineLimits completed(MachineLimits limits, const Job& job, const FitResult& fit,
                        const ControllerSettings& controller) {
  double lowest = INFINITY, highest = -INFINITY, speed = 0.0, voltage = 0.0;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    for (const Sample& s : fit.recordings[r].prediction.samples) {
      lowest = std::min(lowest, s.position);
      highest = std::max(highest, s.position);
      speed = std::max(speed, std::abs(s.velocity));
      voltage = std::max(voltage, std::abs(s.drive_force));
    }
  const Axis<double> axis = fitted_model(job, fit).axis;
  const bool force_source = job.model.structure.drive == Drive::force_source;
  if (!limits.lowest) limits.lowest = lowest;
  if (!limits.highest) limits.highest = highest;
  if (!limits.speed) limits.speed = speed;
  if (!limits.voltage) limits.voltage = force_source ? voltage / axis.K_f : controller.limit;
  limits.voltage = std::min(*limits.voltage, controller.limit);
  return limits;
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
Job with_next(const Job& job, const std::vector<ResidualSeries>& residuals, double duration) {
  Job next = job;
  const Recording& like = first_fitted(job);
  Recording recording;
  recording.name = "next";
  const double interval =
      (like.times.back() - like.times.front()) / static_cast<double>(like.times.size() - 1);
  const auto count = static_cast<std::size_t>(duration / interval) + 1;
  for (std::size_t i = 0; i < count; ++i)
    recording.times.push_back(static_cast<double>(i) * interval);
  const std::size_t start = find_quantity("initial.y0")->index;
  for (const auto& [quantity, value] : like.overrides)
    if (quantity == start) recording.overrides.emplace_back(quantity, value);
  for (const Measurement& m : like.measurements) {
    if (!m.fitted) continue;
    Measurement& measurement = recording.measurements.emplace_back();
    measurement.signal = m.signal;
    measurement.sigma = m.sigma * std::sqrt(excess_of(residuals, job, m.signal));
  }
  for (Recording& r : next.recordings) r.role = Role::validate;
  next.recordings.push_back(std::move(recording));
  return next;
}

/// The commands of a motion; those of a move as its controller writes them.
Schedule commands_of(const Experiment& experiment, const Model<double>& model,
                     const ControllerSettings& controller, std::span<const double> times) {
  const auto* move = std::get_if<MoveMotion>(&experiment.motion);
  if (move == nullptr)
    return schedule_of(experiment.motion, experiment.duration, controller.period);
  SlaveControlUnit unit(controller, reference_of(*move));
  return simulate_controlled(model, unit, times, [](std::size_t, const Integrator<double>&) {});
}

bool keeps_to(const MachineLimits& limits, const Prediction& prediction) {
  // What a recording covered once, a motion may reach.
  constexpr double kTouch = 1e-6;
  return prediction.finished && std::ranges::all_of(prediction.samples, [&](const Sample& s) {
           return s.position >= *limits.lowest - kTouch && s.position <= *limits.highest + kTouch &&
                  std::abs(s.velocity) <= *limits.speed * (1.0 + kTouch);
         });
}

/// Standard errors, of u, from normal equations. An error of one is no knowledge.
Eigen::VectorXd errors_of(Eigen::MatrixXd normal) {
  normal.diagonal().array() += 1.0;
  return normal.inverse().diagonal().cwiseSqrt();
}

}  // namespace

std::vector<Experiment> experiment_family(double voltage, double speed, double travel,
                                          double duration) {
  std::vector<Experiment> family;
  const auto add = [&](const Motion& motion, std::string words) {
    family.push_back({motion, duration, std::move(words)});
  };
  for (const double share : {1.0, 0.5, 0.2, 0.1, 0.05})
    for (const double sign : {1.0, -1.0}) {
      const double u = sign * share * voltage;
      const std::string volts = fmt::format("{:.3g} V", u);
      add(StepMotion{u, 0.0}, "a step of " + volts);
      for (const double part : {0.25, 0.125, 0.0625}) {
        const double hold = part * duration;
        add(LevelsMotion{{u, -u, 0.5 * u, -0.5 * u, 0.2 * u, -0.2 * u, 0.0}, hold},
            fmt::format("levels of {}, -1, 0.5, -0.5, 0.2 and -0.2 times that, then zero, each "
                        "held for {:.3g} s",
                        volts, hold));
        add(LevelsMotion{{u, 0.0, -u, 0.0}, hold},
            fmt::format("levels of {}, zero, the opposite and zero, each held for {:.3g} s", volts,
                        hold));
      }
      for (const double f : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0})
        add(SineMotion{u, f, f}, fmt::format("a sine of {} and {:g} Hz", volts, f));
      for (const double f : {5.0, 20.0, 60.0})
        add(SineMotion{u, 0.5, f}, fmt::format("a chirp of {} from 0.5 to {:g} Hz", volts, f));
      for (const double bit : {0.01, 0.025, 0.05, 0.1, 0.2})
        add(PrbsMotion{u, bit, 0.0, 1},
            fmt::format("a pseudo-random sequence of +-{:.3g} V, a new choice every {:g} s",
                        std::abs(u), bit));
    }
  for (const double distance : {0.9, 0.5, 0.2, -0.9, -0.5, -0.2})
    for (const double share : {0.9, 0.5, 0.2}) {
      if (!(speed > 0.0) || !(travel > 0.0)) continue;
      const MoveMotion move{distance * travel, share * speed, 4.0 * share * speed};
      add(move, fmt::format("a move of {:.3g} m at {:.3g} m/s and {:.3g} m/s^2", move.distance,
                            move.speed, move.acceleration));
    }
  return family;
}

std::optional<Suggestion> suggest_experiment(
    const Job& job, const FitResult& fit, const ControllerSettings& controller,
    const MachineLimits& limits, const std::function<void(int done, int of)>& progress) {
  if (!fit.usable || job.free.empty()) return std::nullopt;
  Suggestion suggestion;
  suggestion.limits = completed(limits, job, fit, controller);
  const Recording& like = first_fitted(job);
  constexpr double kLongest = 10.0;  // s; longer motions repeat themselves
  const double duration = std::min(kLongest, like.times.back() - like.times.front());
  const Model<double> model = fitted_model(job, fit);
  const bool moves =
      job.model.structure.drive != Drive::force_source && model.axis.T_d < controller.period;
  const std::vector<Experiment> family =
      experiment_family(*suggestion.limits.voltage, moves ? *suggestion.limits.speed : 0.0,
                        *suggestion.limits.highest - *suggestion.limits.lowest, duration);

  // What is known already, and what each motion would add to it.
  const Linearization& known = *fit.at_solution;
  const std::vector<ResidualSeries> residuals = residual_series(job, fit);
  Eigen::MatrixXd normal = known.jacobian.transpose() * known.jacobian;
  for (const SeriesRows& rows : known.series) {
    const Signal signal = job.recordings[rows.recording].measurements[rows.measurement].signal;
    const auto block = known.jacobian.middleRows(rows.first, rows.count);
    const double excess = excess_of(residuals, job, signal);
    normal -= (1.0 - 1.0 / excess) * (block.transpose() * block);
  }
  const Job next = with_next(job, residuals, duration);
  const std::size_t added = next.recordings.size() - 1;
  const ParameterSpace space(next);
  const Eigen::VectorXd u = space.internal(values_of(fit));
  std::vector<Linearization> shown(family.size());
  std::mutex mutex;
  int done = 0;
  parallel_for(family.size(), thread_count(job.options.threads), [&](std::size_t i) {
    Job trial = next;
    Recording& recording = trial.recordings[added];
    recording.command = commands_of(family[i], model, controller, recording.times);
    const Prediction prediction = predict(trial, space, added, u.data(), {});
    if (keeps_to(suggestion.limits, prediction)) {
      for (std::size_t m = 0; m < recording.measurements.size(); ++m)
        recording.measurements[m].values = prediction.simulated[m];
      shown[i] = linearize(trial, space, u, fit.coupling_rate);
    }
    const std::lock_guard lock(mutex);
    if (progress) progress(++done, static_cast<int>(family.size()));
  });

  const auto worst_of = [&](const Eigen::VectorXd& errors) {
    std::size_t worst = 0;
    double largest = -1.0;
    for (std::size_t i = 0; i < job.free.size(); ++i) {
      const double error = errors[static_cast<Eigen::Index>(i)];
      // What stands at its bound is as good as known.
      if (fit.parameters[i].uncertainty.at_bound || !(error > largest)) continue;
      largest = error;
      worst = i;
    }
    return std::pair{worst, largest};
  };
  suggestion.parameter = worst_of(errors_of(normal)).first;
  const Linearization* best = nullptr;
  double least = INFINITY;
  for (std::size_t i = 0; i < family.size(); ++i) {
    const Linearization& one = shown[i];
    suggestion.allowed += one.finite ? 1 : 0;
    if (!one.finite) continue;
    // Rows of priors are in both.
    const auto rows = one.jacobian.topRows(one.series.back().first + one.series.back().count);
    const double worst = worst_of(errors_of(normal + rows.transpose() * rows)).second;
    if (!(worst < least)) continue;
    least = worst;
    best = &one;
    suggestion.experiment = family[i];
  }
  suggestion.tried = static_cast<int>(family.size());
  if (best == nullptr) return std::nullopt;

  // As the fit itself will judge, with the new recording's rows before all others.
  const Eigen::Index new_rows = best->series.back().first + best->series.back().count;
  Linearization all;
  all.finite = true;
  all.series = best->series;
  for (SeriesRows rows : known.series) {
    rows.first += new_rows;
    all.series.push_back(rows);
  }
  all.residuals.setZero(new_rows + known.residuals.size());
  all.residuals.tail(known.residuals.size()) = known.residuals;
  all.jacobian.resize(all.residuals.size(), u.size());
  all.jacobian.topRows(new_rows) = best->jacobian.topRows(new_rows);
  all.jacobian.bottomRows(known.jacobian.rows()) = known.jacobian;
  suggestion.now = uncertainty(space, u, known);
  suggestion.predicted = uncertainty(space, u, all);
  return suggestion;
}

}  // namespace axisfit
