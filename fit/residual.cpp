#include "fit/residual.h"

#include <cmath>
#include <utility>

#include "fit/jet.h"

namespace axisfit {
namespace {

Measured measured(const Recording& recording) {
  Measured series;
  if (const Measurement* m = recording.find(Signal::velocity)) series.velocity = m->values;
  if (const Measurement* m = recording.find(Signal::position)) series.position = m->values;
  return series;
}

template <class T, class Read>
SimulationOutcome run(const Job& job, const Recording& recording, const Model<T>& model,
                      const Coupling& coupling, Read&& read) {
  IntegratorOptions options;
  options.step = job.options.step;
  // A recording shows less than one event per sample. Parameters with which the axis chatters
  // faster, as a controller in a limit cycle, are none to go on from.
  options.event_budget = 200 + static_cast<long>(recording.times.size()) / 2;
  return simulate<T>(model, recording.command, recording.times, std::forward<Read>(read), coupling,
                     measured(recording), options);
}

/// sign(r) sqrt(rho(r^2)) for Huber's rho of width k, and its derivative.
std::pair<double, double> robust(double r, double k) {
  const double size = std::abs(r);
  if (size <= k) return {r, 1.0};
  const double root = std::sqrt(2.0 * k * size - k * k);
  return {std::copysign(root, r), k / root};
}

}  // namespace

Coupling coupling_for(const Recording& recording, double rate) {
  if (!(rate > 0.0)) return {};
  const bool position = recording.find(Signal::position) != nullptr;
  if (recording.find(Signal::velocity) != nullptr) return Coupling::to_velocity(rate, position);
  if (position) return Coupling::to_position(rate);
  return {};
}

Prediction predict(const Job& job, const ParameterSpace& space, std::size_t index, const double* u,
                   const Coupling& coupling) {
  const Recording& recording = job.recordings[index];
  Prediction prediction;
  prediction.simulated.assign(recording.measurements.size(), {});
  const SimulationOutcome outcome =
      run<double>(job, recording, space.model_at(u, index), coupling,
                  [&](std::size_t, const Integrator<double>& axis) {
                    for (std::size_t m = 0; m < recording.measurements.size(); ++m)
                      prediction.simulated[m].push_back(
                          reading(axis.equations(), recording.measurements[m].signal, axis.mode(),
                                  axis.state(), axis.input()));
                    if (coupling.active())
                      prediction.coupling_force.push_back(
                          axis.equations().coupling_force(axis.state(), axis.input().target));
                  });
  prediction.finished = outcome.finished;
  prediction.events = outcome.events;
  return prediction;
}

RecordingCost::RecordingCost(const Job& job, const ParameterSpace& space, std::size_t recording,
                             const Coupling& coupling)
    : job_(job), space_(space), recording_(recording), coupling_(coupling) {
  const Recording& r = job.recordings[recording];
  for (std::size_t m = 0; m < r.measurements.size(); ++m)
    if (r.measurements[m].fitted) fitted_.push_back(m);
  for (std::size_t i = 0; i < space.size(); ++i)
    if (space.applies(i, recording)) applicable_.push_back(i);
  set_num_residuals(static_cast<int>(fitted_.size() * r.times.size()));
  mutable_parameter_block_sizes()->push_back(static_cast<int>(space.size()));
}

template <class T>
bool RecordingCost::evaluate(const double* u, double* residuals, double* jacobian,
                             std::span<const std::size_t> columns) const {
  const Recording& recording = job_.recordings[recording_];
  const std::size_t samples = recording.times.size();
  Model<T> model = convert<T>(space_.model_at(u, recording_));
  if constexpr (!std::is_same_v<T, double>) {
    const std::vector<T*> member = members(model);
    for (std::size_t k = 0; k < columns.size(); ++k)
      member[space_[columns[k]].quantity]->v[static_cast<Eigen::Index>(k)] =
          space_.slope(columns[k], u[columns[k]]);
  }
  bool finite = true;
  const SimulationOutcome outcome =
      run<T>(job_, recording, model, coupling_, [&](std::size_t i, const Integrator<T>& axis) {
        for (std::size_t f = 0; f < fitted_.size(); ++f) {
          const Measurement& m = recording.measurements[fitted_[f]];
          const T simulated =
              reading(axis.equations(), m.signal, axis.mode(), axis.state(), axis.input());
          double r = (m.values[i] - value_of(simulated)) / m.sigma, weight = 1.0;
          if (job_.options.loss == Loss::huber)
            std::tie(r, weight) = robust(r, job_.options.huber_width);
          const std::size_t row = f * samples + i;
          residuals[row] = r;
          finite = finite && std::isfinite(r);
          if constexpr (!std::is_same_v<T, double>) {
            for (std::size_t k = 0; k < columns.size(); ++k) {
              const double d = -weight * simulated.v[static_cast<Eigen::Index>(k)] / m.sigma;
              jacobian[row * space_.size() + columns[k]] = d;
              finite = finite && std::isfinite(d);
            }
          }
        }
      });
  return outcome.finished && finite;
}

bool RecordingCost::Evaluate(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  const double* u = parameters[0];
  if (jacobians == nullptr || jacobians[0] == nullptr)
    return evaluate<double>(u, residuals, nullptr, {});
  double* jacobian = jacobians[0];
  std::fill_n(jacobian, static_cast<std::size_t>(num_residuals()) * space_.size(), 0.0);
  // One pass for all parameters, in the narrowest dual number that holds them; more than the widest
  // holds take several passes.
  constexpr std::size_t kWidest = 24;
  std::span<const std::size_t> rest = applicable_;
  do {
    const auto columns = rest.first(std::min(rest.size(), kWidest));
    rest = rest.subspan(columns.size());
    const std::size_t n = columns.size();
    const bool finished =
        n <= 2    ? evaluate<ceres::Jet<double, 2>>(u, residuals, jacobian, columns)
        : n <= 4  ? evaluate<ceres::Jet<double, 4>>(u, residuals, jacobian, columns)
        : n <= 6  ? evaluate<ceres::Jet<double, 6>>(u, residuals, jacobian, columns)
        : n <= 8  ? evaluate<ceres::Jet<double, 8>>(u, residuals, jacobian, columns)
        : n <= 12 ? evaluate<ceres::Jet<double, 12>>(u, residuals, jacobian, columns)
                  : evaluate<ceres::Jet<double, 24>>(u, residuals, jacobian, columns);
    if (!finished) return false;
  } while (!rest.empty());
  return true;
}

}  // namespace axisfit
