#include "fit/estimate/inverse_dynamics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fit/data/derivative.h"
#include "fit/solve/jet.h"
#include "fit/solve/least_squares.h"
#include "fit/solve/parameters.h"
#include "sim/controller.h"
#include "sim/equations.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double x : values) sum += x * x;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, values.size())));
}

/// Mean of a command over an interval about any instant. It belongs to the mean acceleration there,
/// and has no jump at a switch.
class MeanCommand {
 public:
  explicit MeanCommand(const Schedule& command) : command_(command) {
    double sum = 0.0;
    for (std::size_t k = 0; k < command.times.size(); ++k) {
      if (k > 0) sum += mean_after(k - 1, command.times[k]) * (command.times[k] - time(k - 1));
      impulse_.push_back(sum);
    }
  }

  /// V, about t (s).
  template <class T>
  T at(const T& t, double interval) const {
    return (impulse<T>(t + 0.5 * interval) - impulse<T>(t - 0.5 * interval)) / interval;
  }

 private:
  double time(std::size_t k) const { return command_.times[k]; }
  double value_after(std::size_t k, double t) const {
    return command_.values[k] + command_.slope_after(k) * (t - time(k));
  }
  double mean_after(std::size_t k, double t) const {
    return 0.5 * (command_.values[k] + value_after(k, t));
  }
  /// V s, since the first instant. Its derivative is the command.
  template <class T>
  T impulse(const T& at) const {
    const double t = value_of(at);
    const auto after = std::upper_bound(command_.times.begin(), command_.times.end(), t);
    double sum = 0.0, value = 0.0;
    if (after == command_.times.begin()) {
      value = command_.hold == Hold::linear ? command_.values.front() : 0.0;
      sum = value * (t - time(0));
    } else {
      const auto k = static_cast<std::size_t>(after - command_.times.begin()) - 1;
      value = value_after(k, t);
      sum = impulse_[k] + mean_after(k, t) * (t - time(k));
    }
    return T(sum) + value * (at - t);
  }

  const Schedule& command_;
  std::vector<double> impulse_;
};

/// What a recording shows of the motion, on an even grid.
struct Trajectory {
  std::size_t recording = 0;
  double interval = 0.0;                         ///< s
  std::vector<double> position, velocity, rate;  ///< m, m/s, m/s^2
  std::vector<double> current;                   ///< A, of an electric drive
  Schedule command;               ///< of the drive, by its controller where that wrote it
  std::vector<double> counts;     ///< 1 where forces are balanced, 0 at rest and near the ends
  double cutoff = 0.0;            ///< Hz, of the low-pass of both sides
  std::vector<std::size_t> rows;  ///< samples that remain after it
  double weight = 1.0;            ///< 1/N
};

/// A measured signal as the arm had it: on an even grid, without gain, bias and delays.
std::optional<std::vector<double>> truth_of(const Recording& recording, const Model<double>& model,
                                            Signal signal) {
  const Measurement* m = recording.find(signal);
  if (m == nullptr || recording.times.size() < 2) return std::nullopt;
  const Instrument<double>& instrument = model.instruments[index_of(signal)];
  std::vector<double> values = m->values;
  for (double& x : values) x = (x - instrument.bias) / instrument.gain;
  if (!std::ranges::all_of(values, [](double x) { return std::isfinite(x); })) return std::nullopt;
  const double late =
      (instrument.lag + instrument.delay) / mean_interval(recording.times) + delay_of(m->filter);
  values = on_even_grid(recording.times, values);
  return late > 0.0 ? advanced(values, late) : values;
}

/// Position, velocity and acceleration by a zero-phase filter. None where there is neither a
/// velocity nor a position, or too few samples for one.
std::optional<Trajectory> trajectory_of(const Job& job, const Model<double>& model,
                                        std::size_t index) {
  const Recording& recording = job.recordings[index];
  Trajectory path;
  path.recording = index;
  const auto position = truth_of(recording, model, Signal::position);
  const auto velocity = truth_of(recording, model, Signal::velocity);
  constexpr std::size_t kFewest = 50;
  if ((!position && !velocity) || recording.times.size() < kFewest) return std::nullopt;
  if (capabilities(model.structure).is_electric) {
    auto current = truth_of(recording, model, Signal::motor_current);
    if (!current) return std::nullopt;
    path.current = *std::move(current);
  }
  path.command = recording.command;
  if (recording.command.meaning == Meaning::reference) {
    if (!position) return std::nullopt;
    path.command = {
        recording.times,
        command_from_reference(
            model.controller, recording.times,
            recorded_reference(model.controller.timing, recording.command, recording.times.front()),
            recording.find(Signal::position)->values)};
  }
  const double h = path.interval = mean_interval(recording.times);
  const double sigma = recording.find(velocity ? Signal::velocity : Signal::position)->sigma;
  const int derivatives = velocity ? 1 : 2;  // that make an acceleration
  const auto filter_motion = [&] {
    // The motion passes all that both sides of the balance keep, and hardly more.
    const double cutoff = std::min(5.0 * path.cutoff, 0.4 / h);
    path.position =
        low_pass(position.value_or(std::vector<double>(recording.times.size())), h, cutoff);
    path.velocity =
        velocity ? low_pass(*velocity, h, cutoff) : central_differences(path.position, h);
    path.rate = central_differences(path.velocity, h);
    return cutoff;
  };
  // As in the measurement of a missing force, but for what noise of the acceleration does to a
  // mass: that falls short by the square of its part in the acceleration.
  constexpr double kHighest = 40.0, kLowest = 1.0, kNoise = 0.03;
  path.cutoff = std::min(kHighest, 0.1 / h);
  double wide = filter_motion();
  while (path.cutoff > kLowest && sigma * noise_gain(derivatives, path.cutoff, h) >
                                      kNoise * rms(low_pass(path.rate, h, path.cutoff))) {
    path.cutoff *= 0.5;
    wide = filter_motion();
  }
  if (!position) {
    path.position[0] = model.initial[0];
    for (std::size_t i = 1; i < path.velocity.size(); ++i)
      path.position[i] = path.position[i - 1] + 0.5 * h * (path.velocity[i - 1] + path.velocity[i]);
  }
  const double fastest =
      std::abs(*std::ranges::max_element(path.velocity, {}, [](double v) { return std::abs(v); }));
  const double rest = std::max(0.005 * fastest, 4.0 * sigma * noise_gain(derivatives - 1, wide, h));
  const auto edge = static_cast<std::size_t>(std::ceil(1.0 / (path.cutoff * h)));
  const std::size_t n = path.velocity.size();
  path.counts.assign(n, 0.0);
  for (std::size_t i = edge; i + edge < n; ++i)
    path.counts[i] =
        std::abs(path.velocity[i]) > rest && (recording.held_out.empty() || !recording.held_out[i]);
  // Nothing remains of parts at rest; of the rest, as many samples as the low-pass leaves apart.
  const std::vector<double> remaining = low_pass(path.counts, h, path.cutoff);
  const auto stride = std::max<std::size_t>(1, static_cast<std::size_t>(0.4 / (path.cutoff * h)));
  for (std::size_t i = edge; i + edge < n; i += stride)
    if (remaining[i] > 0.5) path.rows.push_back(i);
  if (path.rows.size() < kFewest / 2) return std::nullopt;
  return path;
}

/// The model as the balance has it: rigid, with the current of an electric drive as a state.
Model<double> balanced_model(Model<double> model) {
  model.structure.transmission = Transmission::rigid;
  if (capabilities(model.structure).is_electric) model.structure.drive = Drive::velocity_loop;
  model.structure.effects.reset(*effect_named("elastic_mode"));
  return model;
}

/// What remains of the balance of forces along a trajectory, filtered, N times the weight.
class BalanceCost : public ceres::CostFunction {
 public:
  BalanceCost(const Job& job, const ParameterSpace& space, const Trajectory& path)
      : job_(job), space_(space), path_(path) {
    for (std::size_t i = 0; i < space.size(); ++i)
      if (space.applies(i, path.recording)) applicable_.push_back(i);
    set_num_residuals(static_cast<int>(path.rows.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(space.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const double* u = parameters[0];
    const Model<double> values = balanced_model(model_at(job_, space_, u, path_.recording));
    if (jacobians == nullptr || jacobians[0] == nullptr)
      return store(
          imbalance(values), [](double x) { return x; }, residuals, 1);
    std::fill_n(jacobians[0], path_.rows.size() * space_.size(), 0.0);
    return evaluate_columns(applicable_, [&]<class Jet>(std::span<const std::size_t> columns,
                                                        bool is_first) {
      const std::vector<Jet> balance = imbalance(with_derivatives<Jet>(values, space_, u, columns));
      bool finite = true;
      if (is_first)
        finite = store(
            balance, [](const Jet& x) { return x.a; }, residuals, 1);
      for (std::size_t k = 0; k < columns.size(); ++k)
        finite = store(
                     balance, [k](const Jet& x) { return x.v[static_cast<Eigen::Index>(k)]; },
                     jacobians[0] + columns[k], space_.size()) &&
                 finite;
      return finite;
    });
  }

 private:
  /// N, of every sample that counts: the force that M a takes beyond those of the model.
  template <class T>
  std::vector<T> imbalance(const Model<T>& model) const {
    const Recording& recording = job_.recordings[path_.recording];
    const Equations<T> equations(model);
    const std::vector<T> commands = commands_of(equations, recording);
    const T mass = equations.moving_mass();
    State<T> y{};
    Input<T> input;
    std::optional<Mode> before;
    std::vector<T> forces;
    forces.reserve(path_.velocity.size());
    for (std::size_t i = 0; i < path_.velocity.size(); ++i) {
      y[0] = T(path_.position[i]);
      y[1] = T(path_.velocity[i]);
      y[2] = y[0] / motor_radius(model);
      y[3] = y[1] / motor_radius(model);
      if (!path_.current.empty()) y[6] = T(path_.current[i]);
      y[7] = commands[i];
      input.command = commands[i];
      const double time = recording.times.front() + static_cast<double>(i) * path_.interval;
      input.time = T(time);
      input.channels = recording.course_at(time);
      if (!before) input.memory = {y[0], {}};
      const Mode mode = equations.mode_at(y, input);
      if (before && mode.sliding != before->sliding && before->sliding != 0) {
        State<T> stopped = y;  // hystereses remember where the arm turned
        equations.cross(*before, Guard::stop, stopped, input);
      }
      before = mode;
      forces.push_back(path_.counts[i] > 0.0
                           ? mass * (path_.rate[i] - equations.acceleration(mode, y, input))
                           : T(0.0));
    }
    return forces;
  }

  /// V, what the drive follows at every sample.
  template <class T>
  std::vector<T> commands_of(const Equations<T>& equations, const Recording& recording) const {
    std::vector<T> commands(path_.velocity.size(), T(0.0));
    if (!path_.current.empty()) return commands;
    const MeanCommand command(path_.command);
    const T delay = equations.model().axis.T_d + equations.lag_of_switching();
    for (std::size_t i = 0; i < commands.size(); ++i)
      commands[i] =
          command.at<T>(recording.times.front() + static_cast<double>(i) * path_.interval - delay,
                        path_.interval);
    if (!equations.parts().lagging) return commands;
    using std::exp;
    const T lag = slots::affine(equations.model().effects, equations.parts().effects).drive_lag;
    const T kept = exp(-path_.interval / lag);
    for (std::size_t i = 1; i < commands.size(); ++i)
      commands[i] += kept * (commands[i - 1] - commands[i]);
    return commands;
  }

  /// Whether the part of the forces is finite after the low-pass.
  template <class T, class Part>
  bool store(const std::vector<T>& forces, Part&& part, double* to, std::size_t stride) const {
    std::vector<double> values;
    values.reserve(forces.size());
    for (const T& force : forces) values.push_back(part(force));
    values = low_pass(std::move(values), path_.interval, path_.cutoff);
    bool finite = true;
    for (std::size_t row = 0; row < path_.rows.size(); ++row) {
      to[row * stride] = path_.weight * values[path_.rows[row]];
      finite = finite && std::isfinite(to[row * stride]);
    }
    return finite;
  }

  const Job& job_;
  const ParameterSpace& space_;
  const Trajectory& path_;
  std::vector<std::size_t> applicable_;
};

Costs costs_of(const Job& job, const ParameterSpace& space, const std::vector<Trajectory>& paths) {
  Costs costs;
  for (const Trajectory& path : paths)
    costs.push_back(std::make_unique<BalanceCost>(job, space, path));
  return costs;
}

/// The job without a free parameter, which keeps its initial value.
void hold(Job& job, std::size_t parameter) {
  const FreeParameter p = job.free[parameter];
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    if (!p.recording || *p.recording == r)
      job.recordings[r].overrides.emplace_back(p.quantity, p.initial);
  job.free.erase(job.free.begin() + static_cast<std::ptrdiff_t>(parameter));
}

bool is_free(const Job& job, std::string_view name) {
  return std::ranges::count(job.free, quantity_index(name), &FreeParameter::quantity) > 0;
}

/// Whether the balance of forces can determine a quantity of the job.
bool is_balanced(const Job& job, const QuantityEntry& entry) {
  if (entry.group == "elastic_mode" || (!entry.group.empty() && !entry.effect)) return false;
  const bool is_gain = entry.name == "K_f" || entry.name == "K_m" || entry.name == "r_g";
  return !(is_gain && is_free(job, "M"));
}

/// Fixes the parameters that the balance cannot determine; returns the places in the job of the
/// others.
std::vector<std::size_t> keep_balanced(Job& job, const std::vector<Trajectory>& paths) {
  std::vector<std::size_t> places(job.free.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  const auto hold_all = [&](auto&& is_held) {
    for (std::size_t i = job.free.size(); i-- > 0;)
      if (is_held(i)) {
        hold(job, i);
        places.erase(places.begin() + static_cast<std::ptrdiff_t>(i));
      }
  };
  const Job given = job;
  hold_all(
      [&](std::size_t i) { return !is_balanced(given, quantity_list()[given.free[i].quantity]); });
  if (job.free.empty()) return {};
  const ParameterSpace space(job);
  const Linearization at =
      linearize(space, costs_of(job, space, paths), space.internal(initial_values(job)));
  if (!at.finite) return {};
  const Eigen::Index rows = at.series.front().count;
  hold_all([&](std::size_t i) {
    return at.jacobian.col(static_cast<Eigen::Index>(i)).head(rows).isZero(0.0);
  });
  return places;
}

/// Weighs the recordings by what remains of them; that of all together, N rms.
double weigh(std::vector<Trajectory>& paths, const Eigen::VectorXd& residuals) {
  double sum = 0.0, count = 0.0;
  Eigen::Index row = 0;
  for (Trajectory& path : paths) {
    const auto n = static_cast<Eigen::Index>(path.rows.size());
    const double mean_square =
        residuals.segment(row, n).squaredNorm() / (path.weight * path.weight);
    sum += mean_square;
    count += static_cast<double>(n);
    if (mean_square > 0.0) path.weight = std::sqrt(static_cast<double>(n) / mean_square);
    row += n;
  }
  return std::sqrt(sum / count);
}

/// N rms of the drive force over what counts.
double drive_rms_of(const Job& job, const ParameterSpace& space, const Eigen::VectorXd& u,
                    const std::vector<Trajectory>& paths) {
  double sum = 0.0, count = 0.0;
  for (const Trajectory& path : paths) {
    const Model<double> model = balanced_model(model_at(job, space, u.data(), path.recording));
    const Equations<double> equations(model);
    const Recording& recording = job.recordings[path.recording];
    const MeanCommand command(path.command);
    std::vector<double> drive;
    for (std::size_t i = 0; i < path.counts.size(); ++i) {
      State<double> y{};
      Input<double> input;
      if (path.current.empty())
        input.command = y[7] = command.at<double>(
            recording.times.front() + static_cast<double>(i) * path.interval - model.axis.T_d,
            path.interval);
      else
        y[6] = path.current[i];
      drive.push_back(path.counts[i] * equations.current_force({}, y, input));
    }
    drive = low_pass(std::move(drive), path.interval, path.cutoff);
    for (const std::size_t row : path.rows) sum += drive[row] * drive[row];
    count += static_cast<double>(path.rows.size());
  }
  return std::sqrt(sum / std::max(1.0, count));
}

}  // namespace

std::optional<InverseDynamics> inverse_dynamics(const Job& job) {
  InverseDynamics found;
  std::vector<Trajectory> paths;
  Job balanced = job;
  const ParameterSpace declared(job);
  const std::vector<double> initial = initial_values(job);
  const Eigen::VectorXd start = declared.internal(initial);
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    if (job.recordings[r].role != Role::fit) continue;
    if (auto path = trajectory_of(job, model_at(job, declared, start.data(), r), r))
      paths.push_back(*std::move(path));
  }
  if (paths.empty() || job.free.empty()) return std::nullopt;
  found.exact = !capabilities(job.model.structure).has_backlash &&
                !job.model.structure.effects[*effect_named("elastic_mode")];

  const std::vector<std::size_t> places = keep_balanced(balanced, paths);
  if (places.empty()) return std::nullopt;
  const ParameterSpace space(balanced);
  Eigen::VectorXd u(static_cast<Eigen::Index>(space.size()));
  for (std::size_t i = 0; i < space.size(); ++i)
    u[static_cast<Eigen::Index>(i)] = space.internal(i, balanced.free[i].initial);
  constexpr int kWeighings = 3;
  for (int pass = 0; pass <= kWeighings; ++pass) {
    SolveOptions options;
    options.penalize_distance_from_start = pass == 0;  // a parameter that it cannot tell stays
    const SolveResult solved = minimize(space, costs_of(balanced, space, paths), u, options);
    if (!solved.usable) return std::nullopt;
    u = solved.u;
    const Eigen::VectorXd residuals = residuals_at(space, costs_of(balanced, space, paths), u);
    if (residuals.size() == 0) return std::nullopt;
    found.residual = weigh(paths, residuals);
  }
  Linearization at = linearize(space, costs_of(balanced, space, paths), u);
  at.series.clear();
  Eigen::Index row = 0;
  found.cutoff = paths.front().cutoff;
  for (const Trajectory& path : paths) {
    const auto n = static_cast<Eigen::Index>(path.rows.size());
    at.series.push_back({path.recording, 0, row, n});
    row += n;
    found.cutoff = std::min(found.cutoff, path.cutoff);
  }
  found.drive_rms = drive_rms_of(balanced, space, u, paths);
  const Uncertainty known = uncertainty(space, u, at);
  const std::vector<double> values = space.values(u);
  for (std::size_t i = 0; i < space.size(); ++i) {
    if (!known.parameters[i].determined) continue;
    InverseEstimate& estimate = found.parameters.emplace_back();
    estimate.id = space[i].id();
    estimate.value = values[i];
    estimate.uncertainty = known.parameters[i];
    estimate.budget = known.budgets[i];
    estimate.parameter = places[i];
  }
  if (found.parameters.empty()) return std::nullopt;
  return found;
}

std::vector<double> start_from(const Job& job, const InverseDynamics& estimate) {
  std::vector<double> values = initial_values(job);
  for (const InverseEstimate& e : estimate.parameters) {
    const FreeParameter& p = job.free[e.parameter];
    values[e.parameter] = std::clamp(e.value, p.lower, p.upper);
  }
  return values;
}

}  // namespace axisfit
