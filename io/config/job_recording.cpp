#include "io/config/job_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "fit/criterion/gains.h"
#include "fit/data/derivative.h"
#include "fit/data/initial_state.h"
#include "fit/data/noise.h"
#include "fit/data/standstill.h"
#include "fit/data/validation.h"
#include "io/config/axis_file.h"
#include "io/config/channels.h"
#include "io/config/recording_input.h"
#include "io/config/recording_keys.h"
#include "io/config/recording_measurement.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

class RecordingReader {
 public:
  RecordingReader(const Rig& rig, const RecordingSources& sources) : rig_(rig), series_(sources) {}

  Recording read(const ConfigNode& node) {
    Recording recording;
    ConfigMap map(node, recording_keys());
    std::optional<std::string> path;
    const auto file = map.read("file", path);
    if (path) {
      recording.file = *path;
      recording.name = std::filesystem::path(*path).stem().string();
    }
    map.read("name", recording.name);
    map.read("role", recording.role);
    map.read("initial_state", recording.initial_state);
    map.read("initial_samples", recording.initial_samples);
    map.read("acceleration_at_standstill", recording.acceleration_at_standstill);
    map.read("score_initial_samples", recording.score_initial_samples);
    if (const auto set = map.optional("set")) read_overrides(*set, recording);
    const auto times = read_clock(map);
    const auto signals = map.required("signals");
    const auto channels = map.optional("channels");
    const auto trim = map.optional("trim");
    if (path && series_.open_own(*file, *path) && times && signals) {
      times->rate ? series_.make_own_times(times->node, *times->rate)
                  : series_.read_own_times(times->node);
      read_samples(times->node, *signals, channels, trim, recording);
    }
    if (rig_.model.structure.channels != nullptr && !channels)
      node.error(
          fmt::format("'{}' lacks the channels of the axis, or of the other recordings: name "
                      "their columns under 'channels'",
                      recording.name));
    map.finish();
    return recording;
  }

 private:
  void read_overrides(const ConfigNode& node, Recording& recording) {
    ConfigMap map(node);
    Structure structure = rig_.model.structure;
    structure.closed_loop = true;  // if the recording has a reference
    for (const auto& [key, value] : map.entries())
      if (const QuantityEntry* entry = quantity_named(key, structure))
        if (const auto given = read_value(value, entry->quantity))
          recording.overrides.emplace_back(entry->index, *given);
    map.finish();
  }

  using Values = std::vector<double>;

  /// The key that tells the times of the samples.
  struct Clock {
    ConfigNode node;
    std::optional<double> rate;  ///< Hz; none: the node names a column
  };

  /// Nothing, with a diagnostic, where there is neither a column nor a rate, or both.
  static std::optional<Clock> read_clock(ConfigMap& map) {
    std::optional<double> rate;
    const auto of_rate = map.read("rate", rate);
    const auto time = of_rate ? map.optional("time") : map.required("time");
    if (time && of_rate)
      of_rate->error("give either the column of the times or the rate of the samples, not both");
    if (time) return Clock{*time, {}};
    if (of_rate && rate) return Clock{*of_rate, rate};
    return std::nullopt;
  }

  static Trim read_trim(const ConfigNode& node) {
    Trim trim;
    ConfigMap map(node, keys_below(recording_keys(), "trim"));
    map.read("from", trim.from);
    map.read("to", trim.to);
    map.finish();
    return trim;
  }

  void read_samples(const ConfigNode& time_node, const ConfigNode& signals_node,
                    const std::optional<ConfigNode>& channels_node,
                    const std::optional<ConfigNode>& trim_node, Recording& recording) {
    const Trim trim = trim_node ? read_trim(*trim_node) : Trim();
    ConfigMap signals(signals_node, keys_below(recording_keys(), "signals"));
    auto input = read_input(signals_node, signals, rig_, series_, recording);
    std::vector<Measured> measured;
    read_measurements(signals, rig_.model.structure, trim, series_, measured);
    signals.finish();
    std::vector<Schedule> channels;
    if (channels_node) channels = read_channels(*channels_node);
    const auto& recorded = series_.times();
    if (!recorded || !input || recorded->empty()) return;
    // Effects of the time mean that of the recording, and at 1.7e9 s a double is too coarse to
    // step on.
    constexpr double kDay = 86400.0;
    const double begin = std::abs(recorded->front()) > kDay ? recorded->front() : 0.0;
    // Commands from before the first sample kept still act on it.
    Values command_times, commands;
    for (std::size_t i = 0; i < input->times.size() && input->times[i] <= trim.to; ++i) {
      command_times.push_back(input->times[i] - begin);
      commands.push_back(input->values[i]);
    }
    const Values all = common_times(*input, measured, trim);
    Values times = all;
    for (double& t : times) t -= begin;
    recording.times = std::move(times);
    const Meaning meaning = recording.command.meaning;
    recording.command = schedule_from_samples(command_times, commands, recording.command.hold);
    recording.command.meaning = meaning;
    if (recording.times.size() < kLeastSamples) {
      say_too_few(time_node, trim_node, *input, measured, recording.times.size());
      recording.times = {0.0, 1.0};
      return;
    }
    for (std::size_t j = 0; j < channels.size(); ++j) {
      Values values;
      for (const double t : all)
        values.push_back(channels[j].value_at(t) - (*rig_.model.structure.channels)[j].zero);
      recording.channels.emplace_back(std::move(values));
    }
    for (Measured& m : measured) recording.measurements.push_back(on_times(std::move(m), all));
    take_noise_from_standstill(signals_node, recording);
    if (recording.initial_state == InitialState::data) initial_state_from_data(recording);
    if (!recording.acceleration_at_standstill) exclude_acceleration_at_standstill(recording);
  }

  void say_too_few(const ConfigNode& time_node, const std::optional<ConfigNode>& trim_node,
                   const Series& input, const std::vector<Measured>& measured,
                   std::size_t left) const {
    const Values& recorded = *series_.times();
    const std::string samples = fmt::format("{} sample{}", left, left == 1 ? "" : "s");
    const bool own = std::ranges::any_of(
        measured, [&](const Measured& m) { return m.series.own_clock || input.own_clock; });
    trim_node.value_or(time_node).error(
        trim_node
            ? fmt::format("only {} of {}, from {:g} s to {:g} s, remain: at least 10 are needed",
                          samples, recorded.size(), recorded.front(), recorded.back())
        : own ? fmt::format("while the input was recorded, from {:g} s to {:g} s, there are "
                            "only {}, and at least 10 are needed: correct the offset of the "
                            "times",
                            input.times.front(), input.times.back(), samples)
              : fmt::format("the recording has only {}: at least 10 are needed", samples));
  }

  /// The times of all that was measured while the input is known; of the recording where nothing
  /// was. Those of several clocks that are closer than a simulation steps are one.
  Values common_times(const Series& input, const std::vector<Measured>& measured,
                      const Trim& trim) const {
    Values times;
    for (const Measured& m : measured)
      times.insert(times.end(), m.series.times.begin(), m.series.times.end());
    if (measured.empty()) times = *series_.times();
    std::ranges::sort(times);
    // Not std::ranges::unique, which clang 14 cannot compile with this library.
    times.erase(
        std::unique(times.begin(), times.end(),
                    [](double before, double time) { return time - before < kShortestStep; }),
        times.end());
    const double last_input =
        input.own_clock && input.times.size() > 1
            ? input.times.back() + (input.times.back() - input.times[input.times.size() - 2])
            : kUnlimited;
    std::erase_if(times, [&](double t) {
      return !trim.keeps(t) || t < input.times.front() || t > last_input;
    });
    return times;
  }

  /// All channels of the axis over the recorded time, straight between their values. Nothing, with
  /// diagnostics, where one is wrong or missing.
  std::vector<Schedule> read_channels(const ConfigNode& node) {
    std::vector<Schedule> channels;
    ConfigMap map(node);
    if (!node.is_map() || rig_.model.structure.channels == nullptr) {
      map.finish();
      return channels;
    }
    for (const Channel& channel : *rig_.model.structure.channels) {
      const auto given = map.required(channel.name);
      if (!given) continue;
      ConfigMap column(*given, channel_column_keys());
      int order = 0;
      column.read("derivative", order);
      if (auto series = series_.read(*given, column, integrated(channel.unit, order))) {
        if (order > 0) differentiate(*series, order);
        channels.push_back({std::move(series->times), std::move(series->values), Hold::linear});
      }
      column.finish();
    }
    map.finish();
    if (channels.size() < rig_.model.structure.channels->size()) channels.clear();
    return channels;
  }

  static void differentiate(Series& series, int order) {
    const double interval = mean_interval(series.times), start = series.times.front();
    series.values =
        derivative(on_even_grid(series.times, std::move(series.values)), interval, order);
    for (std::size_t i = 0; i < series.times.size(); ++i)
      series.times[i] = start + static_cast<double>(i) * interval;
  }

  void take_noise_from_standstill(const ConfigNode& signals_node, Recording& recording) const {
    for (Measurement& m : recording.measurements) {
      if (m.noise != NoiseSource::standstill) continue;
      if (const double noise = noise_at_standstill(recording, m); noise >= kMinSigma)
        m.sigma = noise;
      else
        signals_node.error(
            fmt::format("this recording has no standstill of 50 samples, or no velocity or "
                        "position to detect one: give the sigma of {}, or omit it",
                        info(m.signal, vocabulary()).name));
    }
  }

  Vocabulary vocabulary() const { return vocabulary_of(rig_.model.structure); }

  const Rig& rig_;
  SeriesReader series_;
};

}  // namespace

Recording read_recording(const ConfigNode& node, const Rig& rig, const RecordingSources& sources) {
  return RecordingReader(rig, sources).read(node);
}

}  // namespace axisfit
