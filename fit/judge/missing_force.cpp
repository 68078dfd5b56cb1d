#include "fit/judge/missing_force.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "fit/criterion/gains.h"
#include "fit/solve/residual.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

constexpr double kPi = std::numbers::pi;

double rms(const std::vector<double>& values, std::size_t first) {
  double sum = 0.0;
  for (std::size_t i = first; i < values.size(); ++i) sum += values[i] * values[i];
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, values.size() - first)));
}

/// N rms of the low-passed observer force that white noise of the measurement makes: the observer
/// tracks a velocity like k / (s + k), a position like (2 w s + w^2) / (s + w)^2.
double noise_floor(const Recording& recording, const Observer& observer, double mass,
                   double interval, double cutoff) {
  const Measurement* m =
      recording.find(observer.velocity > 0.0 ? Signal::velocity : Signal::position);
  double power = 0.0;
  constexpr int kPoints = 400;
  const double nyquist = 0.5 / interval, df = nyquist / kPoints;
  for (int i = 0; i < kPoints; ++i) {
    const double f = (i + 0.5) * df;
    const std::complex<double> s(0.0, 2.0 * kPi * f);
    std::complex<double> h;
    if (observer.velocity > 0.0) {
      h = observer.velocity * s / (s + observer.velocity);
    } else {
      const double w = std::sqrt(observer.acceleration);
      h = observer.acceleration * s * s / ((s + w) * (s + w));
    }
    const double low = 1.0 / (1.0 + std::pow(f / cutoff, 8));  // amplitude of both runs
    power += std::norm(h) * low * low * df / nyquist;
  }
  // At these frequencies correlated noise is that much stronger than white noise of the same size.
  return mass * m->sigma *
         std::sqrt(power * noise_correlation_time(*m) * static_cast<double>(m->hold));
}

}  // namespace

double percent_of_drive(const MissingForce& force) {
  if (!force.found || force.rms < 2.0 * force.noise) return 0.0;
  return 100.0 * std::sqrt(force.rms * force.rms - force.noise * force.noise) / force.drive_rms;
}

MissingForce missing_force(const Job& job, const FitResult& result, std::size_t index) {
  MissingForce missing;
  const Recording& recording = job.recordings[index];
  if (!observer_for(recording, 1.0).active()) return missing;
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(values_of(result));
  const Model<double> model = model_at(job, space, u.data(), index);
  const double mass = Equations<double>(model).moving_mass();
  const double interval = mean_interval(recording.times);
  double largest = 0.0;
  missing.cutoff = std::min(40.0, 0.1 / interval);
  const auto observer = [&] { return observer_for(recording, 2.0 * kPi * missing.cutoff); };
  // The free run tells how large the drive force is; where it does not finish, one that tracks.
  std::vector<Sample> samples = result.recordings[index].free_running.samples;
  if (samples.empty())
    samples = simulate_recording(job, space, index, u.data(), observer()).samples;
  for (const Sample& s : samples) largest = std::max(largest, std::abs(s.drive_force));
  const auto floor = [&] {
    return noise_floor(recording, observer(), mass, interval, missing.cutoff);
  };
  while (missing.cutoff > 5.0 && floor() > 0.01 * largest) missing.cutoff *= 0.5;
  missing.noise = floor();

  const SimulatedRecording tracking = simulate_recording(job, space, index, u.data(), observer());
  if (!tracking.finished) return missing;
  std::vector<double> force, drive;
  for (const Sample& s : tracking.samples) {
    force.push_back(s.observer_force);
    drive.push_back(s.drive_force);
  }
  missing.force = low_pass(std::move(force), interval, missing.cutoff);
  missing.samples = tracking.samples;
  const std::size_t first = recording.score_initial_samples ? 0 : recording.initial_samples;
  missing.rms = rms(missing.force, first);
  missing.drive_rms = rms(low_pass(std::move(drive), interval, missing.cutoff), first);
  missing.found = true;
  return missing;
}

std::vector<MissingForce> missing_forces(const Job& job, const FitResult& result) {
  std::vector<MissingForce> forces;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    forces.push_back(missing_force(job, result, r));
  return forces;
}

}  // namespace axisfit
