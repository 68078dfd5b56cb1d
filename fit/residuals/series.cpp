#include "fit/residuals/series.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace axisfit {

std::vector<ResidualSeries> residual_series(const Job& job, const FitResult& result) {
  std::vector<ResidualSeries> list;
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    const Prediction& prediction = result.recordings[r].judged();
    if (!prediction.finished) continue;
    for (std::size_t m = 0; m < recording.measurements.size(); ++m) {
      const Measurement& measurement = recording.measurements[m];
      if (!measurement.fitted) continue;
      ResidualSeries fitted{r, m, true, {}, {}}, judged{r, m, false, {}, {}};
      const std::size_t first = recording.score_initial_samples ? 0 : recording.initial_samples;
      for (std::size_t i = first; i < recording.times.size(); ++i) {
        if (!measurement.counts(i)) continue;
        ResidualSeries& series = recording.fits(measurement, i) ? fitted : judged;
        series.samples.push_back(i);
        series.values.push_back((measurement.values[i] - prediction.simulated[m][i]) /
                                measurement.sigma);
      }
      for (ResidualSeries* series : {&fitted, &judged})
        if (!series->values.empty()) list.push_back(std::move(*series));
    }
  }
  return list;
}

double mean_square(std::span<const double> values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
         static_cast<double>(std::max<std::size_t>(1, values.size()));
}

double autocorrelation_time(std::span<const double> values) {
  const std::size_t n = values.size();
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) /
                      static_cast<double>(std::max<std::size_t>(1, n));
  const auto covariance = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < n; ++i) sum += (values[i] - mean) * (values[i - lag] - mean);
    return sum;
  };
  const double variance = covariance(0);
  if (!(variance > 0.0)) return 1.0;
  double time = 1.0;
  double previous = covariance(1);
  for (std::size_t lag = 1; lag + 1 < n / 4; lag += 2) {
    const double next = covariance(lag + 1);
    if (previous + next <= 0.0) break;
    time += 2.0 * (previous + next) / variance;
    previous = covariance(lag + 2);
  }
  return std::max(1.0, time);
}

bool is_explained(const ResidualSeries& series) {
  const double n = static_cast<double>(series.values.size());
  const double scatter = 4.0 * std::sqrt(2.0 * autocorrelation_time(series.values) / n);
  return mean_square(series.values) < 1.0 + std::max(0.05, scatter);
}

}  // namespace axisfit
