#include "io/config/recording_measurement.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/units.h"
#include "fit/data/noise.h"
#include "fit/data/validation.h"
#include "io/config/recording_keys.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

/// From the values as they follow each other in the recording.
void take_noise(const ConfigNode& node, const Series& series,
                const std::optional<ConfigNode>& shaped, std::string_view unit,
                Measurement& measurement) {
  Measurement own = measurement;
  own.values = series.values;
  if (shaped) exclude_uninformative(own);
  measurement.sigma = noise_from_differences(own);
  if (!(measurement.sigma >= kMinSigma))
    node.error(
        fmt::format("the noise of {} cannot be estimated from these samples: give its "
                    "sigma, for example 'sigma: {}'",
                    node.name(), with_unit("0.01", unit)));
}

/// Leaves the samples that a filter or a hold leaves, with a diagnostic where that cannot be.
void prepare(const ConfigNode& node, const std::string& signal, Measurement& measurement) {
  const auto n = static_cast<double>(measurement.values.size());
  constexpr double kLeastCycles = 2.0;  // of the cutoff, in the recording
  const Filter& filter = measurement.filter;
  const bool is_short = filter.kind == Filter::Kind::butterworth
                            ? filter.cutoff * n < kLeastCycles
                            : static_cast<double>(filter.length) > n;
  if (!is_short) exclude_uninformative(measurement);
  const auto informative =
      static_cast<std::size_t>(std::ranges::count(measurement.uninformative, false));
  if (static_cast<double>(informative * measurement.hold) > 1.5 * n) {
    node.error(fmt::format("the values of {} do not repeat {} times: correct or remove the hold",
                           signal, measurement.hold));
    return;
  }
  if (is_short || informative < kLeastSamples) {
    node.error(fmt::format(
        "this leaves fewer than 10 samples of the {} that do not depend on what was before "
        "the recording or only repeat: at least 10 are needed",
        signal));
    measurement.filter = Filter();
    measurement.uninformative.clear();
  }
}

std::optional<Measured> read_measurement(const ConfigNode& node, const SignalInfo& signal,
                                         const Trim& trim, SeriesReader& reader) {
  ConfigMap map(node, measurement_keys(signal.name));
  Measurement measurement;
  measurement.signal = signal.signal;
  auto series = reader.read(node, map, signal.unit);
  if (series) keep(trim, *series);
  map.read("fit", measurement.fitted);
  const auto hold = map.optional("hold");
  if (hold) measurement.hold = static_cast<std::size_t>(hold->as_integer(1, kMostHeld).value_or(1));
  const auto filter = map.optional("filter");
  if (filter)
    measurement.filter =
        read_filter(*filter, sampling(series ? series->times : std::vector<double>()));
  if (const auto sigma = map.optional("sigma")) {
    if (sigma->text() == "fit") {
      measurement.noise = NoiseSource::fit;
    } else if (sigma->text() == "standstill") {
      measurement.noise = NoiseSource::standstill;
    } else {
      measurement.sigma = read_sigma(*sigma, signal.unit);
      measurement.noise = NoiseSource::given;
    }
  }
  map.finish();
  if (!series) return std::nullopt;
  const bool is_shaped = measurement.filter != Filter() || measurement.hold > 1;
  std::optional<ConfigNode> shaped;
  if (is_shaped && series->times.size() >= kLeastSamples)
    shaped = filter ? *filter : hold.value_or(node);
  if (measurement.noise != NoiseSource::given)
    take_noise(node, *series, shaped, signal.unit, measurement);
  return Measured{std::move(measurement), std::move(*series), node, std::move(shaped)};
}

}  // namespace

Filter read_filter(const ConfigNode& node, const Sampling& sampling) {
  const Section& keys = keys_below(measurement_keys(kSignalTable.front().name), "filter");
  ConfigMap map(node, keys);
  Filter filter;
  const auto average = map.read("moving_average", filter.length);
  std::optional<double> cutoff;
  std::optional<int> order;
  std::optional<ConfigNode> at;
  const auto butterworth = map.optional("butterworth");
  if (butterworth) {
    ConfigMap of_butterworth(*butterworth, keys_below(keys, "butterworth"));
    of_butterworth.read("order", order);
    at = of_butterworth.read("cutoff", cutoff);
    of_butterworth.finish();
  }
  map.read("zero_phase", filter.zero_phase);
  map.finish();
  if (average.has_value() == butterworth.has_value()) {
    if (node.is_map()) node.error("give either a moving_average or a butterworth filter");
    return {};
  }
  if (sampling.samples < kLeastSamples) return {};
  if (!sampling.is_even() || sampling.gaps > 0) {
    node.error(
        "a filter needs even sampling, and these sample times are uneven: fit the unfiltered "
        "samples, or remove the filter");
    return {};
  }
  if (average) {
    filter.kind = Filter::Kind::moving_average;
    if (!filter.zero_phase || filter.length % 2 == 1) return filter;
    average->error(fmt::format(
        "an average of {} samples has none in the middle: with zero_phase give an odd number",
        filter.length));
    return {};
  }
  if (!order || !cutoff) return {};
  filter.kind = Filter::Kind::butterworth;
  filter.order = *order;
  filter.cutoff = *cutoff * sampling.interval;
  if (filter.cutoff < 0.5) return filter;
  at->error(fmt::format("the cutoff must be below {:.4g} Hz, half the sampling rate",
                        0.5 / sampling.interval));
  return {};
}

void read_measurements(ConfigMap& signals, const Structure& structure, const Trim& trim,
                       SeriesReader& series, std::vector<Measured>& measured) {
  for (const SignalInfo& of_sliding : kSignalTable) {
    const SignalInfo signal = info(of_sliding.signal, vocabulary_of(structure));
    const bool is_input =
        signal.signal == Signal::drive_force && capabilities(structure).is_force_driven;
    const auto given = is_input ? std::nullopt : signals.optional(signal.name);
    if (!given) continue;
    if (auto found = read_measurement(*given, signal, trim, series))
      measured.push_back(std::move(*found));
  }
}

Measurement on_times(Measured measured, const std::vector<double>& times) {
  Measurement measurement = std::move(measured.measurement);
  const Series& series = measured.series;
  std::vector<double> values(times.size(), 0.0);
  std::vector<bool> there(times.size(), false);
  for (std::size_t i = 0, k = 0; i < times.size(); ++i) {
    while (k < series.times.size() && series.times[k] < times[i]) ++k;
    if (k == series.times.size() || series.times[k] - times[i] >= kShortestStep) continue;
    values[i] = series.values[k];
    there[i] = true;
  }
  const bool complete = std::ranges::find(there, false) == there.end();
  measurement.values = complete ? std::move(values) : between(times, std::move(values), there);
  if (!complete) {
    there.flip();
    measurement.uninformative = std::move(there);
  }
  measurement.missing = series.missing;
  if (measured.shaped && !complete) {
    measured.shaped->error(
        fmt::format("a filter or hold needs a value of the {} at every sample time, and at some "
                    "there is none: fit the unfiltered samples, or remove it",
                    measured.node.name()));
  } else if (measured.shaped) {
    prepare(*measured.shaped, measured.node.name(), measurement);
  }
  return measurement;
}

}  // namespace axisfit
