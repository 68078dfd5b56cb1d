#include "fit/estimate/other_gains.h"

#include <utility>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "fit/errors/gain_error.h"
#include "fit/errors/uncertainty.h"
#include "fit/estimate/recipes.h"
#include "fit/solve/parameters.h"
#include "fit/solve/solve.h"

namespace axisfit {
namespace {

/// The fit at another gain, from where this one ended.
FitResult fit_at(Job job, const FitResult& fit, double gain, const RunContext& context) {
  set_initial_values(job, values_of(fit));
  job.options = recipe::quick(job.options);
  job.options.criterion = Tracking{gain};
  return estimate(job, context.quiet());
}

/// The gains at which the fit is repeated; none where it does not track, or is not usable.
std::vector<double> other_gains(const Job& job, const FitResult& fit, const ErrorOptions& options) {
  if (!tracks(job.options.criterion) || !(fit.observer_gain > 0.0) || !fit.is_usable()) return {};
  return {fit.observer_gain / options.other_gain, fit.observer_gain * options.other_gain};
}

/// Estimates at another gain, and their errors, by one step of least squares from this fit; none
/// where the simulation does not finish.
std::optional<EstimatesAtGain> step_at(Job job, const FitResult& fit, double gain,
                                       const ErrorOptions& options) {
  job.options.criterion = Tracking{gain};
  const ParameterSpace space(job);
  Eigen::VectorXd u = space.internal(values_of(fit));
  Linearization at = linearize(job, space, u, gain);
  std::vector<Eigen::Index> moving;
  for (std::size_t i = 0; i < space.size(); ++i)
    if (!fit.parameters[i].uncertainty.at_bound) moving.push_back(static_cast<Eigen::Index>(i));
  if (!at.finite || moving.empty()) return std::nullopt;
  const Eigen::MatrixXd jacobian = at.jacobian(Eigen::all, moving);
  const Eigen::VectorXd step = -LeastSquaresSolver(jacobian).solve(at.residuals);
  at.residuals += jacobian * step;
  u(moving) += step;
  const Uncertainty found = uncertainty(space, u, at, options);
  const std::vector<double> values = space.values(u);
  EstimatesAtGain estimates{gain, fit.parameters};
  for (std::size_t i = 0; i < values.size(); ++i) {
    estimates.parameters[i].value = values[i];
    estimates.parameters[i].uncertainty = found.parameters[i];
  }
  return estimates;
}

void enter_gain_errors(FitResult& fit, std::span<const EstimatesAtGain> estimates,
                       const ErrorOptions& options) {
  const auto shifts = gain_errors(fit.parameters, estimates, options);
  for (std::size_t i = 0; i < shifts.size(); ++i) fit.parameters[i].budget.gain = shifts[i];
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

std::vector<FitResult> fits_at_other_gains(const Job& job, const FitResult& fit,
                                           const RunContext& context, const ErrorOptions& options) {
  const std::vector<double> gains = other_gains(job, fit, options);
  const ThreadPool pool(job.options.threads);
  std::vector<FitResult> fits(gains.size());
  parallel_for(fits.size(), [&](std::size_t k) { fits[k] = fit_at(job, fit, gains[k], context); });
  std::erase_if(fits, [](const FitResult& f) { return !f.is_usable(); });
  return fits;
}

std::vector<FitResult> add_gain_errors(const Job& job, FitResult& fit, const RunContext& context,
                                       const ErrorOptions& options) {
  std::vector<FitResult> others = fits_at_other_gains(job, fit, context, options);
  std::vector<EstimatesAtGain> estimates;
  for (const FitResult& other : others)
    estimates.push_back({other.observer_gain, other.parameters});
  enter_gain_errors(fit, estimates, options);
  return others;
}

void add_linear_gain_errors(const Job& job, FitResult& fit, const ErrorOptions& options) {
  const std::vector<double> gains = other_gains(job, fit, options);
  const ThreadPool pool(job.options.threads);
  std::vector<std::optional<EstimatesAtGain>> found(gains.size());
  parallel_for(found.size(),
               [&](std::size_t k) { found[k] = step_at(job, fit, gains[k], options); });
  std::vector<EstimatesAtGain> estimates;
  for (auto& at : found)
    if (at) estimates.push_back(*std::move(at));
  enter_gain_errors(fit, estimates, options);
}

std::optional<double> better_gain(const Job& job, const FitResult& fit,
                                  std::span<const FitResult> others, const ErrorOptions& options) {
  // The options speak of an error, not of its square.
  double least =
      options.better_gain * options.better_gain * free_running_error(job, fit).value_or(0.0);
  std::optional<double> found;
  for (const FitResult& other : others)
    if (const auto error = free_running_error(job, other); error && *error < least) {
      least = *error;
      found = other.observer_gain;
    }
  return found;
}

}  // namespace axisfit
