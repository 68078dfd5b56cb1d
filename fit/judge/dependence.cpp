#include "fit/judge/dependence.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include "base/distributions.h"
#include "base/parallel.h"
#include "fit/data/noise.h"
#include "fit/judge/outliers.h"

namespace axisfit {
namespace {

struct Regressor {
  const char* name;
  std::function<double(const Sample&, double time)> value;
};

const std::vector<Regressor>& regressors() {
  static const std::vector<Regressor> list{
      {"command", [](const Sample& s, double) { return s.command; }},
      {"velocity", [](const Sample& s, double) { return s.velocity; }},
      {"direction",
       [](const Sample& s, double) { return double((s.velocity > 0.0) - (s.velocity < 0.0)); }},
      {"position", [](const Sample& s, double) { return s.position; }},
      {"motor angle",
       [](const Sample& s, double) {
         const double turn = 2.0 * std::numbers::pi;
         return s.motor_angle - turn * std::floor(s.motor_angle / turn);
       }},
      {"current", [](const Sample& s, double) { return s.current; }},
      {"load", [](const Sample& s, double) { return s.gear_force; }},
      {"time", [](const Sample&, double time) { return time; }},
  };
  return list;
}

/// Range of each value among `ranges` with equally many values, equal values in one of them.
std::vector<std::size_t> quantile_ranges(const std::vector<double>& x, std::size_t ranges) {
  std::vector<double> sorted = x;
  std::ranges::sort(sorted);
  std::vector<std::size_t> range;
  for (const double value : x) {
    const auto below = std::ranges::lower_bound(sorted, value) - sorted.begin();
    range.push_back(static_cast<std::size_t>(below) * ranges / x.size());
  }
  return range;
}

constexpr GradeOptions kOptions;

/// The dependence of a series on a variable; none where it is not beyond chance.
std::optional<Dependence> dependence_on(const std::string& name, const std::vector<double>& x,
                                        const std::vector<double>& values) {
  struct Range {
    double count = 0.0, mean = 0.0;
  };
  std::map<std::size_t, Range> ranges;
  const auto range = quantile_ranges(x, kOptions.ranges);
  for (std::size_t i = 0; i < x.size(); ++i) {
    Range& r = ranges[range[i]];
    r.count += 1.0;
    r.mean += (values[i] - r.mean) / r.count;
  }
  if (ranges.size() < 2) return std::nullopt;  // it does not vary
  const double n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double between = 0.0;
  for (const auto& [_, r] : ranges) between += r.count * (r.mean - mean) * (r.mean - mean);
  // Noise is what is left: what depends on x would look like slow noise.
  std::vector<double> residual = values;
  for (std::size_t i = 0; i < x.size(); ++i) residual[i] -= ranges[range[i]].mean;
  const double time = autocorrelation_time(residual);
  const double degrees_of_freedom = n / time - static_cast<double>(ranges.size());
  if (!(degrees_of_freedom > 3.0 && mean_square(residual) > 0.0)) return std::nullopt;
  const double residual_variance = mean_square(residual) * n / degrees_of_freedom;
  const double groups = static_cast<double>(ranges.size() - 1);
  const double p =
      fisher_upper_tail(between / groups / residual_variance, groups, degrees_of_freedom);
  if (!(p < kOptions.significance)) return std::nullopt;
  return Dependence{name, between / (n * mean_square(values)), p};
}

}  // namespace

std::vector<SeriesTest> test_residuals(const Job& job, const FitResult& result) {
  std::vector<ResidualSeries> list = residual_series(job, result);
  if (result.is_usable()) allow_for_parameters(job, result, list);
  std::vector<SeriesTest> tests(list.size());
  const ThreadPool pool(job.options.threads);
  parallel_for(list.size(), [&](std::size_t s) {
    ResidualSeries& series = list[s];
    SeriesTest& test = tests[s];
    test.reduced_chi_square = mean_square(series.values);
    test.autocorrelation_time = autocorrelation_time(series.values);
    test.explained = is_explained(series);
    // Its noise is that of the signal, and has the colour that the filter gave it.
    Measurement like_signal = job.recordings[series.recording].measurements[series.measurement];
    like_signal.values = series.values;
    like_signal.uninformative.clear();
    const double noise =
        series.noise == NoiseSource::fit ? noise_from_differences(like_signal) : 1.0;
    const double explicable =
        noise * noise + series.allowance + (series.input_noise_given ? series.input_noise : 0.0);
    test.unexplained_percent =
        100.0 * std::sqrt(std::max(0.0, 1.0 - explicable / test.reduced_chi_square));
    const auto& samples = result.recordings[series.recording].as_fitted().samples;
    const Recording& recording = job.recordings[series.recording];
    const auto& times = recording.times;
    std::vector<double> instants;
    for (const std::size_t i : series.samples) instants.push_back(times[i]);
    test.outliers = outliers(series.values, kOptions.outliers);
    std::erase_if(test.outliers, [&](std::size_t i) {
      return std::abs(series.values[i]) < kOptions.outlier_sigmas;
    });
    test.drift = drift(instants, series.values);
    test.resolution = resolution_of(recording.measurements[series.measurement].values);
    const auto look_at = [&](const std::string& name, auto&& value) {
      std::vector<double> x;
      for (const std::size_t k : series.samples) x.push_back(value(k));
      if (auto found = dependence_on(name, x, series.values))
        test.dependences.push_back(std::move(*found));
    };
    for (const Regressor& regressor : regressors())
      look_at(regressor.name,
              [&](std::size_t k) { return regressor.value(samples[k], times[k] - times.front()); });
    for (std::size_t c = 0; c < recording.channels.size(); ++c)
      look_at((*job.model.structure.channels)[c].name,
              [&](std::size_t k) { return recording.channels[c][k]; });
    std::ranges::stable_sort(test.dependences, std::greater{}, &Dependence::fraction);
    test.series = std::move(series);
  });
  return tests;
}

}  // namespace axisfit
