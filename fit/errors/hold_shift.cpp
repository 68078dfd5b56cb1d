#include "fit/errors/hold_shift.h"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"
#include "fit/solve/solve.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

/// A schedule that holds has no samples that repeat the one before: those from which its lines
/// start, one interval ahead of a change, are put back.
Schedule straight_between(const Schedule& held, double interval) {
  Schedule straight;
  straight.hold = Hold::linear;
  straight.meaning = held.meaning;
  for (std::size_t k = 1; k < held.times.size(); ++k)
    interval = std::min(interval, held.times[k] - held.times[k - 1]);
  for (std::size_t k = 0; k < held.times.size(); ++k) {
    const double ahead = held.times[k] - interval;
    if (k > 0 && ahead > held.times[k - 1]) straight.append(ahead, held.values[k - 1]);
    straight.append(held.times[k], held.values[k]);
  }
  return straight;
}

}  // namespace

Job with_other_hold(Job job) {
  for (Recording& recording : job.recordings) {
    Schedule& command = recording.command;
    if (command.meaning == Meaning::reference) continue;
    if (command.hold == Hold::zero_order)
      command = straight_between(command, mean_interval(recording.times));
    else
      command.hold = Hold::zero_order;
  }
  return job;
}

std::vector<std::optional<HoldShift>> hold_shifts(const Job& job,
                                                  std::span<const ParameterResult> parameters,
                                                  const Linearization& at_solution, double excess,
                                                  double observer_gain,
                                                  const ErrorOptions& options) {
  std::vector<std::optional<HoldShift>> shifts(parameters.size());
  std::vector<Eigen::Index> moving;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (!parameters[i].uncertainty.at_bound) moving.push_back(static_cast<Eigen::Index>(i));
  const bool has_hold = std::ranges::any_of(job.recordings, [](const Recording& r) {
    return r.role == Role::fit && r.command.meaning != Meaning::reference;
  });
  if (moving.empty() || !at_solution.finite || !has_hold) return shifts;

  const Job other = with_other_hold(job);
  const ParameterSpace space(other);
  const Eigen::VectorXd u = space.internal(values_of(parameters));
  const Eigen::VectorXd residuals = residuals_at(other, space, u, observer_gain);
  if (residuals.size() != at_solution.residuals.size()) return shifts;
  const Eigen::MatrixXd jacobian = at_solution.jacobian(Eigen::all, moving);
  const Eigen::VectorXd step = -LeastSquaresSolver(jacobian).solve(residuals);
  const double more =
      ((residuals + jacobian * step).squaredNorm() - at_solution.residuals.squaredNorm()) / excess;
  if (!(more < options.excluded_cost)) return shifts;
  for (std::size_t k = 0; k < moving.size(); ++k) {
    const auto i = static_cast<std::size_t>(moving[k]);
    const ParameterUncertainty& known = parameters[i].uncertainty;
    const double shift =
        step[static_cast<Eigen::Index>(k)] * space.slope(i, u[static_cast<Eigen::Index>(i)]);
    if (known.determined && std::abs(shift) > known.standard_error)
      shifts[i] = {parameters[i].value + shift, more < -options.excluded_cost};
  }
  return shifts;
}

}  // namespace axisfit
