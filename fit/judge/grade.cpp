#include "fit/judge/grade.h"

#include <algorithm>
#include <cmath>

namespace axisfit {
namespace {

/// Whether the recordings tell anything of a parameter; of one at its bound, how far away it is.
bool is_informed(const FreeParameter& free, const ParameterUncertainty& u, double part) {
  if (u.is_at_zero()) return true;
  if (!u.at_bound) return u.determined;
  if (!u.has_interval()) return false;
  const auto scale = [&](double x) { return free.scale == Scale::logarithmic ? std::log(x) : x; };
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

/// Whether a constant explains the signal as well as any model, see is_explained().
bool stands_still(const Recording& recording, const Measurement& measurement,
                  const GradeOptions& options) {
  ResidualSeries about_mean;
  about_mean.noise = measurement.noise;
  about_mean.noise_time = noise_correlation_time(measurement);
  double mean = 0.0;
  for (std::size_t i = 0; i < measurement.values.size(); ++i)
    if (recording.fits(measurement, i)) about_mean.values.push_back(measurement.values[i]);
  for (const double x : about_mean.values)
    mean += x / static_cast<double>(about_mean.values.size());
  for (double& x : about_mean.values) x = (x - mean) / measurement.sigma;
  return !about_mean.values.empty() && is_explained(about_mean, options);
}

/// Whether no fitted signal shows a motion: then any model, with any parameters, does as well.
bool stands_still(const Job& job, const GradeOptions& options) {
  bool any = false;
  for (const Recording& recording : job.recordings)
    for (const Measurement& m : recording.measurements) {
      if (recording.role != Role::fit || !m.fitted) continue;
      if (!stands_still(recording, m, options)) return false;
      any = true;
    }
  return any;
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

/// Whether a small missing force would show beside the noise.
bool shows_force(const MissingForce& force, const GradeOptions& options) {
  constexpr double kPerCent = 0.01;
  return force.found && force.noise < kPerCent * options.small_force * force.drive_rms;
}

/// Whether the mass may be none, or anything: the force that the observer adds to it is then as
/// small as the mass happens to be, whatever the model lacks.
bool is_massless(const Job& job, const FitResult& fit) {
  static const std::size_t kMass = quantity_index("M");
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const ParameterUncertainty& known = fit.parameters[i].uncertainty;
    if (job.free[i].quantity == kMass && (!known.determined || known.is_at_zero())) return true;
  }
  return false;
}

bool shows_forces(const Job& job, const FitResult& fit, const Diagnosis& diagnosis,
                  const GradeOptions& options) {
  return !is_massless(job, fit) && !diagnosis.forces.empty() &&
         std::ranges::all_of(diagnosis.forces,
                             [&](const auto& f) { return shows_force(f, options); });
}

/// Of a free run, the time from the beginning for which every signal stays within a hundredth of
/// its range, beyond the noise. None where no signal moves.
std::optional<double> followed_for(const Recording& recording, const SimulatedRecording& run) {
  constexpr double kPart = 0.01, kNoise = 4.0;  // of the range; standard deviations
  std::optional<std::size_t> samples;
  if (!run.finished || run.simulated.size() != recording.measurements.size()) return std::nullopt;
  for (std::size_t m = 0; m < recording.measurements.size(); ++m) {
    const Measurement& measured = recording.measurements[m];
    const auto [low, high] = std::ranges::minmax(measured.values);
    const double band = kPart * (high - low) + kNoise * measured.sigma;
    if (!measured.fitted || !(high > low)) continue;
    std::size_t i = 0;
    while (i < run.simulated[m].size() &&
           (!measured.counts(i) || std::abs(measured.values[i] - run.simulated[m][i]) <= band))
      ++i;
    samples = std::min(samples.value_or(i), i);
  }
  if (!samples) return std::nullopt;
  const std::size_t last = std::min(std::max<std::size_t>(*samples, 1), recording.times.size()) - 1;
  return recording.times[last] - recording.times.front();
}

FitGrade grade_without_uses(const Job& job, const FitResult& fit,
                            const std::optional<Diagnosis>& diagnosis,
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
  if (stands_still(job, options)) return graded(Grade::nothing_determined, {.reason = standstill});
  const FitGrade simulation_found = worst_simulation(job, fit, options);
  const FitGrade force_found = diagnosis ? worst_force(*diagnosis) : FitGrade{};
  if (force_found.percent > options.largest_force) return graded(Grade::model_wrong, force_found);
  const bool is_followed = kind != FitVerdict::Kind::signal_not_followed;
  if (!is_followed || !(simulation_found.percent >= options.least_followed)) {
    FitGrade found = simulation_found.percent >= options.least_followed
                         ? FitGrade{.reason = simulation,
                                    .recording = fit.verdict.recording,
                                    .signal = fit.verdict.signal}
                         : simulation_found;
    // A mass under a recorded force drifts away however right it is.
    const bool only_drifts = diagnosis && std::isfinite(found.percent) &&
                             shows_forces(job, fit, *diagnosis, options) &&
                             force_found.percent < options.small_force;
    if (only_drifts) found.reason = drift;
    return graded(only_drifts ? Grade::usable : Grade::model_wrong, found);
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

}  // namespace

FitUses uses_of(const Job& job, const FitResult& fit, const std::optional<Diagnosis>& diagnosis,
                const GradeOptions& options) {
  FitUses uses;
  const bool validates = std::ranges::count(job.recordings, Role::validate, &Recording::role) > 0;
  for (std::size_t r = 0; r < job.recordings.size() && r < fit.recordings.size(); ++r) {
    if (validates && job.recordings[r].role != Role::validate) continue;
    if (diagnosis && !is_massless(job, fit) && r < diagnosis->forces.size() &&
        shows_force(diagnosis->forces[r], options)) {
      const double percent = percent_of_drive(diagnosis->forces[r]);
      if (!(percent < uses.missing_force_percent.value_or(0.0))) {
        uses.missing_force_percent = percent;
        uses.force_recording = r;
      }
    }
    const auto followed = followed_for(job.recordings[r], fit.recordings[r].free_running);
    if (!followed || *followed >= uses.followed_for.value_or(INFINITY)) continue;
    const Samples& times = job.recordings[r].times;
    uses.followed_for = followed;
    uses.is_followed_to_the_end = *followed >= times.back() - times.front();
  }
  return uses;
}

FitGrade grade_of(const Job& job, const FitResult& fit, const std::optional<Diagnosis>& diagnosis,
                  const GradeOptions& options) {
  FitGrade grade = grade_without_uses(job, fit, diagnosis, options);
  grade.uses = uses_of(job, fit, diagnosis, options);
  return grade;
}

}  // namespace axisfit
