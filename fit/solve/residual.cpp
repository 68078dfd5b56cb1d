#include "fit/solve/residual.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "fit/solve/jet.h"

namespace axisfit {
namespace {

/// The states that a simulation hands on and two disturbances, at most, and as many columns at
/// once.
constexpr int kWidestJet = 24;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The measured values that an observer tracks: without the delay of the filter that they went
/// through, or a high gain would make the axis late. Empty where there are none.
std::vector<double> target_values(const Recording& recording, Signal signal) {
  const Measurement* m = recording.find(signal);
  if (m == nullptr) return {};
  const double delay = delay_of(m->filter);
  return delay > 0.0 ? advanced(m->values, delay) : std::vector<double>(m->values);
}

/// Runs a recording through a model, in windows where there are any, and calls read(i, axis) at
/// every instant of a recorder. `seeded` as in WindowRestarts.
template <class T, class Read>
SimulationResult run(const Job& job, const Recording& recording, const Model<T>& model,
                     const Observer& observer, const Recorder<T>& recorder,
                     std::span<const WindowStart> starts, Read&& read,
                     std::vector<ModeChange>* modes = nullptr, const StopFlag* stop = nullptr,
                     std::span<const Disturbance<T>> disturbances = {}, bool seeded = false) {
  // A controller switches the command at each of its samples.
  const bool is_controlled = recording.command.meaning == Meaning::reference;
  const double period = model.controller.timing.command_period();
  const double step = is_controlled ? std::min(job.options.step, period) : job.options.step;
  const double switches = is_controlled
                              ? (recording.times.back() - recording.times.front()) / period
                              : static_cast<double>(recording.command.times.size());
  IntegratorOptions options = recording_options(recording.times, switches, step);
  options.step = job.options.step;
  options.modes = modes;
  options.stop = stop;
  // The velocity of a force source turns where its command switches, at samples: there its chords
  // are the curve.
  const bool curved_velocity = !capabilities(model.structure).is_force_driven;
  const auto series = [&](Signal signal) {
    if (!observer.active()) return std::vector<double>{};
    const std::vector<double> values = target_values(recording, signal);
    const bool curved = signal == Signal::position || curved_velocity;
    return recorder.refined(curved && !values.empty() ? target_corners(recording.times, values)
                                                      : values);
  };
  const std::vector<double> velocity = series(Signal::velocity),
                            position = series(Signal::position);
  std::vector<ChannelSeries> channels;
  for (const Samples& values : recording.channels)
    channels.push_back({recorder.refined(std::vector<double>(values))});
  WindowRestarts<T> restarts(starts, recorder, seeded);
  const auto begin_and_read = [&](std::size_t i, Integrator<T>& axis) {
    restarts.at(i, axis);
    read(i, axis);
  };
  long weight = 1;
  if constexpr (!std::is_same_v<T, double>) weight += T::DIMENSION;
  if (stop != nullptr) options.step_budget = std::min(options.step_budget, stop->left() / weight);
  const SimulationResult result =
      simulate<T>(model, recording.command, recorder.instants(), begin_and_read, observer,
                  {velocity, position, channels}, options, disturbances);
  if (stop != nullptr) stop->count(weight * result.steps);
  return result;
}

/// Calls visit(x) for the states in use, and for what is remembered where that counts.
template <class T, class Visitor>
void visit_followed(const ActiveTerms& parts, const Model<double>* controlled, State<T>& y,
                    Input<T>& input, ControllerMemory<T>& memory, Visitor&& visit) {
  const std::array<bool, kStates> is_used{true,
                                          true,
                                          true,
                                          true,
                                          parts.has.is_electric,
                                          parts.has.is_electric,
                                          parts.has.has_voltage_loop,
                                          parts.lagging,
                                          parts.elastic,
                                          parts.elastic};
  for (std::size_t i = 0; i < kStates; ++i)
    if (is_used[i]) visit(y[i]);
  if (controlled != nullptr) {
    const ControllerTiming& timing = controlled->controller.timing;
    visit(input.command);
    visit_memory(controlled->controller,
                 std::min(kMostPeriodsLate, whole_periods(timing, controlled->axis.T_d).first),
                 memory, visit);
  }
  if (!parts.needs.hysteresis) return;
  visit(input.memory.position);
  for (T& hysteresis : input.memory.hystereses) visit(hysteresis);
}

/// How many these are.
Eigen::Index states_to_follow(const ActiveTerms& parts, const Model<double>* controlled) {
  State<double> y{};
  Input<double> input;
  ControllerMemory<double> memory;
  Eigen::Index count = 0;
  visit_followed(parts, controlled, y, input, memory, [&](double&) { ++count; });
  return count;
}

/// sign(r) sqrt(rho(r^2)) for Huber's rho of width k, and its derivative.
std::pair<double, double> robust(double r, double k) {
  const double size = std::abs(r);
  if (size <= k) return {r, 1.0};
  const double root = std::sqrt(2.0 * k * size - k * k);
  return {std::copysign(root, r), k / root};
}

}  // namespace

SimulatedRecording simulate_recording(const Job& job, const ParameterSpace& space,
                                      std::size_t index, const double* u,
                                      const Observer& observer) {
  return simulate_recording(job, job.recordings[index], model_at(job, space, u, index), observer);
}

namespace {

SimulatedRecording simulated(const Job& job, const Recording& recording, const Model<double>& model,
                             const Observer& observer, std::span<const WindowStart> starts) {
  std::vector<Signal> signals;
  for (const Measurement& m : recording.measurements) signals.push_back(m.signal);
  Recorder<double> recorder(model.instruments, signals, recording.times);
  SimulatedRecording simulation;
  const std::vector<double> velocity = target_values(recording, Signal::velocity),
                            position = target_values(recording, Signal::position);
  // The force is the sample's: that of the target is periodic between samples, and not zero at
  // them.
  const MeasuredSeries measured{velocity, position};
  const SimulationResult simulation_result = run(
      job, recording, model, observer, recorder, starts,
      [&](std::size_t i, const Integrator<double>& axis) {
        recorder.read(axis);
        if (!recorder.is_sample(i)) return;
        const Equations<double>& equations = axis.equations();
        const State<double>& y = axis.state();
        const double drive = equations.drive_force(axis.mode(), y, axis.input());
        simulation.samples.push_back(
            {axis.input().command, y[0], y[1], y[2],
             equations.current(axis.mode(), y, axis.input()), drive,
             capabilities(model.structure).has_backlash ? equations.gear_force(axis.mode(), y)
                                                        : drive,
             observer.active() ? equations.observer_force(axis.mode(), y, axis.input(),
                                                          measured.at(simulation.samples.size()))
                               : 0.0});
      },
      &simulation.modes);
  for (std::size_t m = 0; m < signals.size(); ++m)
    simulation.simulated.push_back(
        filtered(recording.measurements[m].filter, recorder.readings(m)));
  simulation.finished = simulation_result.finished;
  simulation.events = simulation_result.events;
  return simulation;
}

}  // namespace

SimulatedRecording simulate_recording(const Job& job, const Recording& recording,
                                      const Model<double>& model, const Observer& observer) {
  return simulated(job, recording, model, observer, {});
}

SimulatedRecording simulate_freely(const Job& job, const ParameterSpace& space, std::size_t index,
                                   const double* u) {
  const Recording& recording = job.recordings[index];
  std::vector<WindowStart> starts;
  if (recording.role == Role::fit && std::holds_alternative<FreeRun>(job.options.criterion))
    starts = RecordingCost(job, space, index, {}).starts(u);
  return simulated(job, recording, model_at(job, space, u, index), {}, starts);
}

std::optional<SimulatedRecording> simulate_in_windows(const Job& job, const ParameterSpace& space,
                                                      std::size_t index, const double* u,
                                                      double share) {
  const double length = window_length(job.options.criterion);
  if (!(length > 0.0)) return std::nullopt;
  Job fitted = job;
  Recording& recording = fitted.recordings[index];
  recording.role = Role::fit;
  for (Measurement& m : recording.measurements) m.fitted = true;
  recording.held_out.clear();
  if (share < 1.0) {
    constexpr double kFewest = 20.0;
    const Partition windows = windows_of(recording, length);
    for (std::size_t k = 0; k < windows.parts(); ++k) {
      const auto samples = static_cast<double>(windows.size(k));
      const double known = std::min(samples, std::max(kFewest, share * samples));
      recording.held_out.resize(windows.first(k) + static_cast<std::size_t>(known), false);
      recording.held_out.resize(windows.first(k + 1), true);
    }
  }
  const RecordingCost cost(fitted, space, index, {});
  const std::vector<WindowStart> starts = cost.starts(u);
  if (starts.empty()) return std::nullopt;
  return simulated(job, job.recordings[index], model_at(job, space, u, index), {}, starts);
}

RecordingCost::RecordingCost(const Job& job, const ParameterSpace& space, std::size_t recording,
                             const Observer& observer, const StopFlag* stop)
    : job_(job), space_(space), recording_(recording), observer_(observer), stop_(stop) {
  const Recording& r = job.recordings[recording];
  if (!observer.active()) windows_ = window_starts(job, recording);
  int residuals = 0;
  for (std::size_t m = 0; m < r.measurements.size(); ++m) {
    const Measurement& measurement = r.measurements[m];
    if (!measurement.fitted) continue;
    fitted_.push_back(m);
    signals_.push_back(measurement.signal);
    std::size_t window = 0;
    for (std::size_t i = 0; i < r.times.size(); ++i) {
      while (window + 1 < windows_.size() && windows_[window + 1].sample <= i) ++window;
      if (!r.fits(measurement, i)) continue;
      ++residuals;
      if (!windows_.empty()) window_of_.push_back(window);
    }
  }
  for (std::size_t i = 0; i < space.size(); ++i)
    if (space.applies(i, recording)) applicable_.push_back(i);
  set_num_residuals(residuals);
  mutable_parameter_block_sizes()->push_back(static_cast<int>(space.size()));
}

template <class T>
bool RecordingCost::evaluate(const double* u, std::span<const WindowStart> starts,
                             double* residuals, double* jacobian,
                             std::span<const std::size_t> columns) const {
  const Model<double> values = model_at(job_, space_, u, recording_);
  Model<T> model;
  if constexpr (std::is_same_v<T, double>)
    model = values;
  else
    model = with_derivatives<T>(values, space_, u, columns);
  const Recording& recording = job_.recordings[recording_];
  Recorder<T> recorder(model.instruments, signals_, recording.times);
  const auto read = [&](std::size_t, const Integrator<T>& axis) { recorder.read(axis); };
  return run(job_, recording, model, observer_, recorder, starts, read, nullptr, stop_).finished &&
         compare(recorder, residuals, {jacobian, space_.size(), columns});
}

template <class T>
bool RecordingCost::compare(Recorder<T>& recorder, double* residuals,
                            const Derivatives& derivatives) const {
  const Recording& recording = job_.recordings[recording_];
  bool finite = true;
  std::size_t row = 0;
  for (std::size_t f = 0; f < fitted_.size(); ++f) {
    const Measurement& m = recording.measurements[fitted_[f]];
    const std::vector<T> simulated = filtered(m.filter, recorder.readings(f));
    for (std::size_t i = 0; i < simulated.size(); ++i) {
      if (!recording.fits(m, i)) continue;
      double r = (m.values[i] - value_of(simulated[i])) / m.sigma, weight = 1.0;
      if (job_.options.loss == Loss::huber)
        std::tie(r, weight) = robust(r, job_.options.huber_width);
      if (residuals != nullptr) residuals[row] = r;
      finite = finite && std::isfinite(r);
      if constexpr (!std::is_same_v<T, double>) {
        for (std::size_t k = 0; k < derivatives.columns.size(); ++k) {
          const double d = -weight * simulated[i].v[static_cast<Eigen::Index>(k)] / m.sigma;
          derivatives.data[row * derivatives.stride + derivatives.columns[k]] = d;
          finite = finite && std::isfinite(d);
        }
      }
      ++row;
    }
  }
  return finite;
}

bool RecordingCost::Evaluate(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  if (is_set(stop_)) return false;
  const double* const u = parameters[0];
  const std::optional<WindowStates> states = window_states(u);
  if (!states) return false;
  if (jacobians == nullptr || jacobians[0] == nullptr)
    return evaluate<double>(u, states->starts(), residuals, nullptr, {});
  double* const jacobian = jacobians[0];
  std::fill_n(jacobian, static_cast<std::size_t>(num_residuals()) * space_.size(), 0.0);
  if (!evaluate_columns(applicable_,
                        [&]<class Jet>(std::span<const std::size_t> columns, bool is_first) {
                          return evaluate<Jet>(u, states->starts(), is_first ? residuals : nullptr,
                                               jacobian, columns);
                        }))
    return false;
  states->eliminate_from(
      Eigen::Map<RowMajor>(jacobian, num_residuals(), static_cast<Eigen::Index>(space_.size())));
  return true;
}

std::optional<WindowStates> RecordingCost::window_states(const double* u) const {
  using T = ceres::Jet<double, WindowStates::kStates>;
  WindowStates states(windows_, window_of_);
  if (windows_.empty()) return states;
  const Model<T> model = convert<T>(model_at(job_, space_, u, recording_));
  Eigen::VectorXd residuals(num_residuals());
  WindowStates::Columns derivatives(num_residuals(), WindowStates::kStates);
  const std::array<std::size_t, WindowStates::kStates> columns{0, 1};
  for (bool goes_on = true; goes_on;) {
    Recorder<T> recorder(model.instruments, signals_, job_.recordings[recording_].times);
    const auto read = [&](std::size_t, const Integrator<T>& axis) { recorder.read(axis); };
    if (!run(job_, job_.recordings[recording_], model, observer_, recorder, states.starts(), read,
             nullptr, stop_, {}, true)
             .finished ||
        !compare(recorder, residuals.data(), {derivatives.data(), WindowStates::kStates, columns}))
      return std::nullopt;
    goes_on = states.improve(residuals, derivatives);
  }
  return states;
}

std::vector<WindowStart> RecordingCost::starts(const double* u) const {
  const std::optional<WindowStates> states = window_states(u);
  return states ? states->starts() : windows_;
}

std::vector<AxisInstant> RecordingCost::trajectory(const double* u) const {
  const Recording& recording = job_.recordings[recording_];
  const Model<double> model = model_at(job_, space_, u, recording_);
  const Recorder<double> recorder(model.instruments, signals_, recording.times);
  std::vector<AxisInstant> instants;
  const std::vector<WindowStart> starts = this->starts(u);
  auto next = starts.begin();
  const auto note = [&](std::size_t i, const Integrator<double>& axis) {
    const bool is_moved = next != starts.end() && recorder.instant_of(next->sample) == i;
    if (is_moved) ++next;
    instants.push_back({axis.mode(), axis.state(), axis.input(), is_moved});
  };
  if (!run(job_, recording, model, observer_, recorder, starts, note, nullptr, stop_).finished)
    return {};
  return instants;
}

/// How a simulation hands small changes of its state on, from each instant to the next. With s the
/// change of the state and of what is remembered, d the disturbance (arm, motor) at an instant and
/// m its mean since the instant before, s_i = from_state s_(i-1) + from_disturbance m_i, and a
/// reading changes by of_state s_i + of_disturbance d_i.
struct RecordingCost::Transitions {
  static constexpr Eigen::Index kDisturbances = 2;
  Eigen::Index states = 0;
  /// Instant by instant one below the other: for each state, and for each signal, a row.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> states_to, readings_to;
  std::vector<std::vector<double>> readings;  ///< their values, by signals
};

template <class T>
std::optional<RecordingCost::Transitions> RecordingCost::transitions(
    const Model<double>& values, std::span<const WindowStart> starts) const {
  const Recording& recording = job_.recordings[recording_];
  const Model<T> model = convert<T>(values);
  const Recorder<T> recorder(model.instruments, signals_, recording.times);
  const auto instants = static_cast<Eigen::Index>(recorder.instants().size());
  Transitions result;
  const Model<double>* controlled = is_controlled() ? &values : nullptr;
  result.states = states_to_follow(Equations<double>(values).parts(), controlled);
  const Eigen::Index n = result.states, wide = n + Transitions::kDisturbances;
  const auto signals = static_cast<Eigen::Index>(signals_.size());
  result.states_to.setZero(instants * n, wide);
  result.readings_to.setZero(instants * signals, wide);
  result.readings.resize(signals_.size());
  Disturbance<T> unit;
  unit.arm.v[n] = 1.0;
  unit.motor.v[n + 1] = 1.0;
  const std::vector<Disturbance<T>> disturbances(recorder.instants().size(), unit);
  const auto read = [&](std::size_t i, Integrator<T>& axis) {
    const auto at = static_cast<Eigen::Index>(i);
    axis.differentiate([&](State<T>& y, Input<T>& input, ControllerMemory<T>& memory) {
      Eigen::Index k = 0;
      visit_followed(axis.equations().parts(), controlled, y, input, memory, [&](T& x) {
        if (i > 0) result.states_to.row(at * n + k) = x.v.head(wide);
        x.v.setZero();
        x.v[k++] = 1.0;
      });
    });
    for (Eigen::Index s = 0; s < signals; ++s) {
      const auto signal = static_cast<std::size_t>(s);
      const T shown =
          reading(axis.equations(), signals_[signal], axis.mode(), axis.state(), axis.input());
      result.readings[signal].push_back(shown.a);
      result.readings_to.row(at * signals + s) = shown.v.head(wide);
    }
  };
  if (!run(job_, recording, model, observer_, recorder, starts, read, nullptr, stop_,
           std::span<const Disturbance<T>>(disturbances))
           .finished)
    return std::nullopt;
  return result;
}

Eigen::MatrixXd RecordingCost::disturbance_response(const double* u,
                                                    const Disturbances& disturbances) const {
  const Model<double> values = model_at(job_, space_, u, recording_);
  constexpr Eigen::Index kNarrow = 12;
  const Eigen::Index width =
      states_to_follow(Equations<double>(values).parts(), is_controlled() ? &values : nullptr) +
      Transitions::kDisturbances;
  if (width > kWidestJet) return {};
  const std::optional<WindowStates> states = window_states(u);
  if (!states) return {};
  const std::optional<Transitions> found =
      width <= kNarrow ? transitions<ceres::Jet<double, kNarrow>>(values, states->starts())
                       : transitions<ceres::Jet<double, kWidestJet>>(values, states->starts());
  if (!found) return {};
  const Eigen::Index n = found->states, all = disturbances.arm.cols(),
                     signals = static_cast<Eigen::Index>(signals_.size());
  // The readings after lags, filters and division by sigma, in as many dual parts as there are.
  using T = ceres::Jet<double, kWidestJet>;
  const Model<T> model = convert<T>(values);
  Eigen::MatrixXd response(num_residuals(), all);
  std::vector<double> residuals(static_cast<std::size_t>(num_residuals()));
  std::vector<std::size_t> columns(kWidestJet);
  std::iota(columns.begin(), columns.end(), 0);
  RowMajor block(num_residuals(), kWidestJet);
  for (Eigen::Index first = 0; first < all; first += kWidestJet) {
    const Eigen::Index count = std::min<Eigen::Index>(kWidestJet, all - first);
    Recorder<T> recorder(model.instruments, signals_, job_.recordings[recording_].times);
    // The changes of the state, and below them the disturbance.
    Eigen::Matrix<double, Eigen::Dynamic, kWidestJet> change =
        Eigen::Matrix<double, Eigen::Dynamic, kWidestJet>::Zero(n + Transitions::kDisturbances,
                                                                kWidestJet);
    const auto disturb = [&](Eigen::Index i, double share) {
      change.row(n).head(count) += share * disturbances.arm.row(i).segment(first, count);
      change.row(n + 1).head(count) += share * disturbances.motor.row(i).segment(first, count);
    };
    for (Eigen::Index i = 0; i < disturbances.arm.rows(); ++i) {
      if (i > 0) {
        change.bottomRows(Transitions::kDisturbances) *= 0.5;
        disturb(i, 0.5);
        if (disturbances.arm_mean.size() > 0)
          change.row(n).head(count) = disturbances.arm_mean.row(i).segment(first, count);
        change.topRows(n) = (found->states_to.middleRows(i * n, n) * change).eval();
        change.bottomRows(Transitions::kDisturbances).setZero();
      }
      disturb(i, 1.0);
      for (Eigen::Index s = 0; s < signals; ++s) {
        const auto signal = static_cast<std::size_t>(s);
        T shown(found->readings[signal][static_cast<std::size_t>(i)]);
        shown.v = (found->readings_to.row(i * signals + s) * change).transpose();
        recorder.note(signal, shown);
      }
    }
    if (!compare<T>(recorder, residuals.data(), {block.data(), kWidestJet, std::span(columns)}))
      return {};
    states->eliminate_from(block);
    response.middleCols(first, count) = block.leftCols(count);
  }
  return response;
}

}  // namespace axisfit
