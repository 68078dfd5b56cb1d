#include "fit/judge/grade.h"

#include <algorithm>
#include <cmath>

namespace axisfit {
namespace {

/// Whether the recordings tell anything of a parameter; of one at its bound, how far away it is.
bool is_informed(const FreeParameter& free, const ParameterUncertainty& u, double part) {
  if (!u.at_bound) return u.determined;
  if (!u.has_interval()) return false;
  const auto scale = [&](double x) { return free.logarithmic ? std::log(x) : x; };
  return scale(u.upper) - scale(u.lower) < part * (scale(free.upper) - scale(free.lower));
}

double variance_of(const Recording& recording, const Measurement& measurement) {
  double n = 0.0, mean = 0.0, sum = 0.0;
  const std::size_t first = recording.score_initial_samples ? 0 : recording.initial_samples;
  for (std::size_t i = first; i < measurement.values.size(); ++i) {
    if (!measurement.counts(i)) continue;
    const double deviation = measurement.values[i] - mean;
    mean += deviation / ++n;
    sum += deviation * (measurement.values[i] - mean);
  }
  return n > 0.0 ? sum / n : 0.0;
}

/// How well a simulation with these errors follows a signal, see FitGrade::percent.
double followed_percent(double variance, const SignalError& error, double noisy_chi_square) {
  const bool noise_known = error.noise != NoiseSource::fit;
  const double noise = noise_known ? error.sigma * error.sigma : 0.0;
  const double unexplained = std::max(0.0, error.rmse * error.rmse - noise);
  // A residual that is hardly more than noise proves nothing.
  if (unexplained == 0.0 || (noise_known && error.reduced_chi_square <= noisy_chi_square))
    return 100.0;
  return 100.0 * (1.0 - std::sqrt(unexplained / std::max(variance - noise, 0.0)));
}

/// The worst signal of the free-running simulation.
FitGrade worst_simulation(const Job& job, const FitResult& fit, const GradeOptions& options) {
  FitGrade worst{.reason = FitGrade::Reason::simulation, .percent = 100.0};
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    for (std::size_t m = 0; m < job.recordings[r].measurements.size(); ++m) {
      const Measurement& measurement = job.recordings[r].measurements[m];
      if (!measurement.fitted) continue;
      const bool finished = fit.recordings[r].free_running.finished;
      const double percent =
          finished ? followed_percent(variance_of(job.recordings[r], measurement),
                                      fit.recordings[r].signals[m], options.noisy_chi_square)
                   : NAN;
      if (percent >= worst.percent) continue;
      worst.recording = r;
      worst.signal = measurement.signal;
      worst.percent = percent;
      if (!finished) return worst;
    }
  return worst;
}

/// The recording whose missing force, noise set aside, is the largest part of the drive's.
FitGrade worst_force(const Diagnosis& diagnosis) {
  FitGrade worst{.reason = FitGrade::Reason::force};
  for (std::size_t r = 0; r < diagnosis.forces.size(); ++r) {
    const double percent = percent_of_drive(diagnosis.forces[r]);
    if (!(percent > worst.percent)) continue;
    worst.recording = r;
    worst.percent = percent;
  }
  return worst;
}

}  // namespace

FitGrade grade_of(const Job& job, const FitResult& fit, const std::optional<Diagnosis>& diagnosis,
                  const GradeOptions& options) {
  using enum FitGrade::Reason;
  const auto graded = [](Grade grade, FitGrade basis) {
    basis.grade = grade;
    return basis;
  };
  const FitVerdict::Kind kind = fit.verdict.kind;
  if (kind == FitVerdict::Kind::not_simulated || kind == FitVerdict::Kind::no_minimum) return {};
  bool informed = false;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    informed =
        informed || is_informed(job.free[i], fit.parameters[i].uncertainty, options.informed_part);
  if (!informed) return graded(Grade::nothing_determined, {.reason = parameters});
  const FitGrade simulation_found = worst_simulation(job, fit, options);
  if (kind == FitVerdict::Kind::signal_not_followed)
    return graded(Grade::model_wrong, simulation_found.percent >= options.least_followed
                                          ? FitGrade{.reason = simulation,
                                                     .recording = fit.verdict.recording,
                                                     .signal = fit.verdict.signal}
                                          : simulation_found);
  const FitGrade force_found = diagnosis ? worst_force(*diagnosis) : FitGrade{};
  if (force_found.percent > options.largest_force) return graded(Grade::model_wrong, force_found);
  if (!(simulation_found.percent >= options.least_followed)) {
    const bool only_drifts = fit.observer_gain > 0.0 && diagnosis &&
                             std::isfinite(simulation_found.percent) &&
                             force_found.percent < options.small_force;
    FitGrade found = graded(only_drifts ? Grade::usable : Grade::model_wrong, simulation_found);
    if (only_drifts) found.reason = tracking_only;
    return found;
  }
  if (diagnosis && diagnosis->explained) return graded(Grade::explained, {.reason = none});
  FitGrade found{.grade = Grade::usable, .reason = residual};
  if (diagnosis && !diagnosis->tests.empty()) {
    const SeriesTest& worst =
        *std::ranges::max_element(diagnosis->tests, {}, &SeriesTest::unexplained_percent);
    found.recording = worst.series.recording;
    found.signal = job.recordings[found.recording].measurements[worst.series.measurement].signal;
    found.percent = worst.unexplained_percent;
  }
  return found;
}

}  // namespace axisfit
