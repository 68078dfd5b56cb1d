#include "fit/estimate/kalman_gain.h"

#include <algorithm>
#include <cmath>

#include "fit/criterion/gains.h"
#include "fit/errors/input_noise.h"
#include "fit/solve/solve.h"
#include "sim/sampling.h"

namespace axisfit {

std::optional<double> kalman_gain(const Job& job, const std::vector<double>& values) {
  const double high = highest_gain(job);
  if (!std::isfinite(high)) return std::nullopt;
  Job few = job;
  few.options.input_noise_draws = 8;
  few.options.criterion = Tracking{high};
  const ParameterSpace space(few);
  const Eigen::VectorXd u = space.internal(values);
  const Linearization at = linearize(few, space, u, high);
  const std::optional<InputNoise> noise = input_noise(few, space, u, high, at);
  if (!noise) return std::nullopt;
  std::optional<double> gain;
  for (std::size_t s = 0; s < at.series.size(); ++s) {
    const Recording& recording = job.recordings[at.series[s].recording];
    const Signal signal = recording.measurements[at.series[s].measurement].signal;
    const bool of_velocity = recording.find(Signal::velocity) != nullptr;
    if (signal != (of_velocity ? Signal::velocity : Signal::position)) continue;
    // White noise of density q in the acceleration makes q / (2 g) of the velocity's mean square
    // at a gain g, and q / (4 g^3) of the position's.
    const double square = noise->mean_squares.row(static_cast<Eigen::Index>(s)).mean(),
                 interval = mean_interval(recording.times);
    if (!(square > 0.0)) continue;
    const double own = of_velocity ? std::sqrt(2.0 * high * square / interval)
                                   : std::pow(4.0 * std::pow(high, 3) * square / interval, 0.25);
    gain = std::min({gain.value_or(high), own});
  }
  return gain;
}

std::optional<double> quiet_gain(const Job& job, const FitResult& fit) {
  constexpr double kFarMore = 9.0;  // of the mean square, over that of the readings
  const bool is_moved = fit.is_usable() && fit.observer_gain == 0.0 && fit.at_solution &&
                        fit.at_solution->input_noise &&
                        fit.at_solution->input_noise->mean_squares.maxCoeff() > kFarMore;
  return is_moved ? kalman_gain(job, values_of(fit)) : std::nullopt;
}

bool had_to_track(const Job& asked, const Job& used) {
  return !tracks(asked.options.criterion) && tracks(used.options.criterion) &&
         !asked.choose_criterion;
}

}  // namespace axisfit
