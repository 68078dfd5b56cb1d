#include "fit/estimation/residual.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "fit/estimation/jet.h"

namespace axisfit {
namespace {

/// The measured values that an observer tracks: without the delay of the filter that they went
/// through, or a high gain would make the axis late. Empty where there are none.
std::vector<double> target_values(const Recording& recording, Signal signal) {
  const Measurement* m = recording.find(signal);
  if (m == nullptr) return {};
  const double delay = delay_of(m->filter);
  return delay > 0.0 ? advanced(m->values, delay) : std::vector<double>(m->values);
}

/// Runs a recording through a model, read by a recorder of these signals; `also` sees the axis at
/// every instant of the recorder, and whether that is a sample.
template <class T, class Also>
SimulationResult run(const Job& job, const Recording& recording, const Model<T>& model,
                     const Observer& observer, Recorder<T>& recorder, Also&& also,
                     std::vector<ModeChange>* modes = nullptr, const StopFlag* stop = nullptr,
                     std::span<const Disturbance<T>> disturbances = {}) {
  IntegratorOptions options = recording_options(recording.times, job.options.step);
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
  return simulate<T>(
      model, recording.command, recorder.instants(),
      [&](std::size_t i, const Integrator<T>& axis) {
        recorder.read(axis);
        also(axis, recorder.is_sample(i));
      },
      observer, {velocity, position}, options, disturbances);
}

/// sign(r) sqrt(rho(r^2)) for Huber's rho of width k, and its derivative.
std::pair<double, double> robust(double r, double k) {
  const double size = std::abs(r);
  if (size <= k) return {r, 1.0};
  const double root = std::sqrt(2.0 * k * size - k * k);
  return {std::copysign(root, r), k / root};
}

}  // namespace

Observer observer_for(const Recording& recording, double rate) {
  if (!(rate > 0.0)) return {};
  const bool position = recording.find(Signal::position) != nullptr;
  if (recording.find(Signal::velocity) != nullptr) return Observer::of_velocity(rate, position);
  if (position) return Observer::of_position(rate);
  return {};
}

SimulatedRecording simulate_recording(const Job& job, const ParameterSpace& space,
                                      std::size_t index, const double* u,
                                      const Observer& observer) {
  const Recording& recording = job.recordings[index];
  std::vector<Signal> signals;
  for (const Measurement& m : recording.measurements) signals.push_back(m.signal);
  const Model<double> model = model_at(job, space, u, index);
  Recorder<double> recorder(model.instruments, signals, recording.times);
  SimulatedRecording simulation;
  const std::vector<double> velocity = target_values(recording, Signal::velocity),
                            position = target_values(recording, Signal::position);
  // The force is the sample's: that of the target is periodic between samples, and not zero at
  // them.
  const TargetSeries measured{velocity, position};
  const SimulationResult simulation_result = run(
      job, recording, model, observer, recorder,
      [&](const Integrator<double>& axis, bool is_sample) {
        if (!is_sample) return;
        const Equations<double>& equations = axis.equations();
        const State<double>& y = axis.state();
        const double drive = equations.drive_force(axis.mode(), y, axis.input());
        simulation.samples.push_back(
            {axis.input().command, y[0], y[1], y[2],
             equations.current(axis.mode(), y, axis.input()), drive,
             capabilities(model.structure).has_backlash ? equations.gear_force(axis.mode(), y)
                                                        : drive,
             observer.active() ? equations.observer_force(y, measured.at(simulation.samples.size()))
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

RecordingCost::RecordingCost(const Job& job, const ParameterSpace& space, std::size_t recording,
                             const Observer& observer, const StopFlag* stop)
    : job_(job), space_(space), recording_(recording), observer_(observer), stop_(stop) {
  const Recording& r = job.recordings[recording];
  int residuals = 0;
  for (std::size_t m = 0; m < r.measurements.size(); ++m) {
    const Measurement& measurement = r.measurements[m];
    if (!measurement.fitted) continue;
    fitted_.push_back(m);
    signals_.push_back(measurement.signal);
    for (std::size_t i = 0; i < r.times.size(); ++i) residuals += r.fits(measurement, i);
  }
  for (std::size_t i = 0; i < space.size(); ++i)
    if (space.applies(i, recording)) applicable_.push_back(i);
  set_num_residuals(residuals);
  mutable_parameter_block_sizes()->push_back(static_cast<int>(space.size()));
}

template <class T>
bool RecordingCost::evaluate(const double* u, double* residuals, double* jacobian,
                             std::span<const std::size_t> columns) const {
  const Model<double> values = model_at(job_, space_, u, recording_);
  const Derivatives derivatives{jacobian, space_.size(), columns};
  if constexpr (std::is_same_v<T, double>)
    return evaluate_model<T>(values, {}, residuals, derivatives);
  else
    return evaluate_model<T>(with_derivatives<T>(values, space_, u, columns), {}, residuals,
                             derivatives);
}

template <class T>
bool RecordingCost::evaluate_model(const Model<T>& model,
                                   std::span<const Disturbance<T>> disturbances, double* residuals,
                                   const Derivatives& derivatives) const {
  const Recording& recording = job_.recordings[recording_];
  Recorder<T> recorder(model.instruments, signals_, recording.times);
  if (!run(
           job_, recording, model, observer_, recorder, [](const Integrator<T>&, bool) {}, nullptr,
           stop_, disturbances)
           .finished)
    return false;
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
      residuals[row] = r;
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
  if (jacobians == nullptr || jacobians[0] == nullptr)
    return evaluate<double>(parameters[0], residuals, nullptr, {});
  return evaluate_with_jacobian(parameters[0], residuals, jacobians[0]);
}

bool RecordingCost::evaluate_with_jacobian(const double* u, double* residuals,
                                           double* jacobian) const {
  std::fill_n(jacobian, static_cast<std::size_t>(num_residuals()) * space_.size(), 0.0);
  return evaluate_columns(applicable_, [&]<class Jet>(std::span<const std::size_t> columns) {
    return evaluate<Jet>(u, residuals, jacobian, columns);
  });
}

std::vector<AxisInstant> RecordingCost::trajectory(const double* u) const {
  const Recording& recording = job_.recordings[recording_];
  const Model<double> model = model_at(job_, space_, u, recording_);
  Recorder<double> recorder(model.instruments, signals_, recording.times);
  std::vector<AxisInstant> instants;
  const auto note = [&](const Integrator<double>& axis, bool) {
    instants.push_back({axis.mode(), axis.state(), axis.input()});
  };
  if (!run(job_, recording, model, observer_, recorder, note, nullptr, stop_).finished) return {};
  return instants;
}

Eigen::MatrixXd RecordingCost::disturbance_response(const double* u,
                                                    const Disturbances& disturbances) const {
  constexpr int kWidth = 24;
  using T = ceres::Jet<double, kWidth>;
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Model<T> model = convert<T>(model_at(job_, space_, u, recording_));
  const Eigen::Index instants = disturbances.arm.rows(), all = disturbances.arm.cols();
  Eigen::MatrixXd response(num_residuals(), all);
  std::vector<double> residuals(static_cast<std::size_t>(num_residuals()));
  std::vector<Disturbance<T>> of_pass(static_cast<std::size_t>(instants));
  std::vector<std::size_t> columns(kWidth);
  std::iota(columns.begin(), columns.end(), 0);
  RowMajor block(num_residuals(), kWidth);
  for (Eigen::Index first = 0; first < all; first += kWidth) {
    const Eigen::Index n = std::min<Eigen::Index>(kWidth, all - first);
    for (Eigen::Index i = 0; i < instants; ++i) {
      Disturbance<T>& at = of_pass[static_cast<std::size_t>(i)];
      at.arm.v.head(n) = disturbances.arm.row(i).segment(first, n).transpose();
      at.motor.v.head(n) = disturbances.motor.row(i).segment(first, n).transpose();
    }
    if (!evaluate_model<T>(
            model, of_pass, residuals.data(),
            {block.data(), kWidth, std::span(columns).first(static_cast<std::size_t>(n))}))
      return {};
    response.middleCols(first, n) = block.leftCols(n);
  }
  return response;
}

}  // namespace axisfit
