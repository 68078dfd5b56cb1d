#include "fit/judge/series.h"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"
#include "fit/errors/input_noise.h"
#include "fit/solve/solve.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

/// Enters what the draws of the inputs' noise add to the series of `at`.
void add_input_noise(const Job& job, const Linearization& at, const InputNoise& noise, bool fitted,
                     std::vector<ResidualSeries>& list) {
  for (std::size_t s = 0; s < at.series.size(); ++s) {
    const SeriesRows& rows = at.series[s];
    ResidualSeries* series = find_series(list, {rows.recording, rows.measurement, fitted});
    if (series == nullptr) continue;
    series->input_noise = noise.mean_squares.row(static_cast<Eigen::Index>(s)).maxCoeff();
    series->input_noise_given = job.recordings[rows.recording].command_noise == NoiseSource::given;
  }
}

/// Whether an event of a simulation passes so close to an instant (s) that no clock would tell on
/// which side of it that is: two parts in a hundred of the interval of the readings.
bool is_at_event(const std::vector<ModeChange>& modes, double time, double interval) {
  constexpr double kPart = 0.02;
  const auto next = std::ranges::lower_bound(modes, time - kPart * interval, {}, &ModeChange::time);
  return next != modes.begin() && next != modes.end() && next->time < time + kPart * interval;
}

}  // namespace

std::vector<ResidualSeries> residual_series(const Job& job, const FitResult& result) {
  std::vector<ResidualSeries> list;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    const SimulatedRecording& simulation = result.recordings[r].as_fitted();
    if (!simulation.finished) continue;
    const double interval = mean_interval(recording.times);
    for (std::size_t m = 0; m < recording.measurements.size(); ++m) {
      const Measurement& measurement = recording.measurements[m];
      if (!measurement.fitted) continue;
      ResidualSeries fitted, unfitted;
      static_cast<SeriesKey&>(fitted) = {r, m, true};
      static_cast<SeriesKey&>(unfitted) = {r, m, false};
      fitted.noise = measurement.noise;
      // From other samples than these.
      if (measurement.noise != NoiseSource::fit) unfitted.noise = measurement.noise;
      fitted.noise_time = unfitted.noise_time = noise_correlation_time(measurement);
      const std::size_t first = recording.score_initial_samples ? 0 : recording.initial_samples;
      for (std::size_t i = first; i < recording.times.size(); ++i) {
        if (!measurement.counts(i)) continue;
        ResidualSeries& series = recording.fits(measurement, i) ? fitted : unfitted;
        const double residual =
            (measurement.values[i] - simulation.simulated[m][i]) / measurement.sigma;
        series.samples.push_back(i);
        series.values.push_back(residual);
        const double excess = residual * residual - 1.0;
        if (excess > 0.0 && is_at_event(simulation.modes, recording.times[i], interval))
          series.at_events += excess;
      }
      for (ResidualSeries* series : {&fitted, &unfitted}) {
        if (series->values.empty()) continue;
        series->at_events /= static_cast<double>(series->values.size());
        list.push_back(std::move(*series));
      }
    }
  }
  if (result.at_solution && result.at_solution->input_noise)
    add_input_noise(job, *result.at_solution, *result.at_solution->input_noise, true, list);
  return list;
}

double samples_of(const std::vector<ResidualSeries>& list) {
  double samples = 0.0;
  for (const ResidualSeries& series : list)
    if (series.fitted) samples += static_cast<double>(series.values.size());
  return samples;
}

void allow_for_parameters(const Job& job, const FitResult& result,
                          std::vector<ResidualSeries>& list) {
  // The recordings to validate, as if they were to be fitted.
  Job other = job;
  for (Recording& r : other.recordings) r.role = r.role == Role::fit ? Role::validate : Role::fit;
  const ParameterSpace space(other);
  const Eigen::VectorXd u = space.internal(values_of(result));
  const Linearization fitted =
      result.at_solution ? *result.at_solution : linearize(job, space, u, result.observer_gain);
  const Linearization unfitted = linearize(other, space, u, result.observer_gain);
  if (!fitted.finite || !unfitted.finite || unfitted.jacobian.rows() == 0) return;
  // Columns of equal length, and what is not determined to one part in a thousand left out: an
  // undetermined parameter must not excuse everything.
  Eigen::VectorXd length = fitted.jacobian.colwise().norm().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled = fitted.jacobian * length.cwiseInverse().asDiagonal();
  auto [size, root] = singular_values(scaled);
  for (Eigen::Index k = 0; k < root.cols(); ++k)
    root.col(k) *= size[k] > 1e-3 ? 1.0 / size[k] : 0.0;
  const Eigen::MatrixXd shown = unfitted.jacobian * length.cwiseInverse().asDiagonal() * root;
  for (const SeriesRows& rows : unfitted.series)
    if (ResidualSeries* series = find_series(list, {rows.recording, rows.measurement, false}))
      series->allowance =
          shown.middleRows(rows.first, rows.count).squaredNorm() / static_cast<double>(rows.count);
  for (Recording& r : other.recordings)
    if (r.command_noise != NoiseSource::given) r.command_sigma = 0.0;
  if (const auto noise = input_noise(other, space, space.internal(values_of(result)),
                                     result.observer_gain, unfitted))
    add_input_noise(other, unfitted, *noise, false, list);
}

bool is_explained(const ResidualSeries& series, const GradeOptions& options) {
  const double root = std::sqrt(static_cast<double>(series.values.size()) / series.noise_time);
  if (series.noise == NoiseSource::fit)
    return autocorrelation_time(series.values) <
           series.noise_time *
               (1.0 + std::max(options.colour_excess, options.colour_errors / root));
  const double spread =
      series.noise == NoiseSource::given ? std::sqrt(2.0) : options.spread_of_estimated_noise;
  const double input = series.input_noise_given ? series.input_noise : 0.0;
  return mean_square(series.values) <
         1.0 + std::max(options.excess, options.errors * spread / root) +
             options.errors * series.allowance + series.at_events + input;
}

bool is_fitted_to_noise(const std::vector<ResidualSeries>& list) {
  return std::ranges::all_of(list,
                             [](const ResidualSeries& s) { return !s.fitted || is_explained(s); });
}

}  // namespace axisfit
