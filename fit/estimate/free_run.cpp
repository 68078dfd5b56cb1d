#include "fit/estimate/free_run.h"

#include <cmath>
#include <optional>

#include "fit/data/noise.h"
#include "fit/solve/residual.h"

namespace axisfit {

std::vector<double> free_run_errors(Job job, std::span<const double> values, std::size_t index,
                                    double horizon) {
  job.options.criterion = Windows{horizon};
  const ParameterSpace space(job);
  const Eigen::VectorXd u = space.internal(values);
  constexpr double kKnown = 0.1;
  auto run = simulate_in_windows(job, space, index, u.data(), kKnown);
  if (!run) run = simulate_recording(job, space, index, u.data(), {});
  if (!run->finished) return {};
  const Recording& recording = job.recordings[index];
  const Partition windows = windows_of(recording, horizon);
  std::vector<double> scales, errors;
  for (const Measurement& m : recording.measurements)
    scales.push_back(standard_deviation(m.values));
  for (std::size_t k = 0; k < windows.parts(); ++k) {
    double sum = 0.0;
    int signals = 0;
    for (std::size_t m = 0; m < recording.measurements.size(); ++m) {
      const Measurement& measured = recording.measurements[m];
      const double scale = scales[m];
      if (!measured.fitted || !(scale > 0.0)) continue;
      double squares = 0.0;
      int samples = 0;
      for (std::size_t i = windows.first(k); i < windows.first(k + 1); ++i) {
        if (!measured.counts(i)) continue;
        squares += std::pow((measured.values[i] - run->simulated[m][i]) / scale, 2);
        ++samples;
      }
      if (samples == 0) continue;
      sum += squares / samples;
      ++signals;
    }
    errors.push_back(sum / signals);  // of none not a number
  }
  return errors;
}

}  // namespace axisfit
