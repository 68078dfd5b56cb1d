#include "io/config/job_recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "fit/data/derivative.h"
#include "fit/data/initial_state.h"
#include "fit/data/noise.h"
#include "fit/data/standstill.h"
#include "fit/estimate/continuation.h"
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
  RecordingReader(const Rig& rig, ObserverMode observer, const RecordingSources& sources)
      : rig_(rig), observer_(observer), series_(sources) {}

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
    const auto initial_samples = map.read("initial_samples", recording.initial_samples);
    map.read("acceleration_at_standstill", recording.acceleration_at_standstill);
    map.read("score_initial_samples", recording.score_initial_samples);
    if (const auto set = map.optional("set")) read_overrides(*set, recording);
    const auto time = map.required("time");
    const auto signals = map.required("signals");
    const auto channels = map.optional("channels");
    const auto trim = map.optional("trim");
    if (path && series_.open_own(*file, *path) && time && signals)
      read_samples(*time, *signals, channels, trim, recording);
    if (rig_.model.structure.channels != nullptr && !channels)
      node.error(
          fmt::format("'{}' lacks the channels of the axis, or of the other recordings: name "
                      "their columns under 'channels'",
                      recording.name));
    if (!recording.score_initial_samples && recording.times.size() >= kLeastSamples &&
        recording.initial_samples >= recording.times.size())
      initial_samples.value_or(node).error(fmt::format(
          "with {} unscored initial samples, nothing of the {} samples is left to score",
          recording.initial_samples, recording.times.size()));
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
    Model<double> model = rig_.model;
    for (const auto& [index, value] : recording.overrides) *members(model)[index] = value;
    if (const std::string reason = model_error(model); !reason.empty()) node.error(reason);
  }

  using Values = std::vector<double>;

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
    series_.read_own_times(time_node);
    const Trim trim = trim_node ? read_trim(*trim_node) : Trim();
    ConfigMap signals(signals_node, keys_below(recording_keys(), "signals"));
    auto input = read_input(signals_node, signals, rig_, series_, recording);
    std::vector<Measured> measured;
    const std::size_t named =
        read_measurements(signals, rig_.model.structure, trim, series_, measured);
    const bool all_known = signals.finish();
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
    if (all_known) check_samples(signals_node, named, recording);
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

  /// Whether the recording has what its role and the options of the fit need.
  void check_samples(const ConfigNode& signals_node, std::size_t named,
                     const Recording& recording) const {
    const bool can_track = recording.find(Signal::position) || recording.find(Signal::velocity);
    if (named == 0) {
      std::vector<std::string_view> names;
      for (const SignalInfo& signal : kSignalTable)
        names.push_back(info(signal.signal, vocabulary()).name);
      signals_node.error(
          fmt::format("no measured signal: name at least one of {}", fmt::join(names, ", ")));
    } else if (recording.role == Role::fit && recording.measurements.size() == named &&
               std::ranges::none_of(recording.measurements, &Measurement::fitted)) {
      signals_node.error(
          "nothing to fit: every signal has fit: false; remove it from one, or give the recording "
          "the role validate");
    }
    if (observer_ == ObserverMode::fixed && !can_track)
      signals_node.error("a fixed observer gain needs a recorded position or velocity");
    Model<double> model = rig_.model;
    const auto member = members(model);
    for (const auto& [quantity, value] : recording.overrides) *member[quantity] = value;
    for (const QuantityEntry& entry : quantity_list(vocabulary()))
      if (const auto reason = ignored_by_observer(entry, observer_, recording);
          !reason.empty() && *member[entry.index] != 0.0)
        signals_node.error(reason);
    for (const Signal target : {Signal::position, Signal::velocity})
      if (const Measurement* m = recording.find(target);
          m != nullptr && observer_ == ObserverMode::fixed && m->filter != Filter() &&
          !m->filter.zero_phase)
        signals_node.error(fmt::format(
            "a fixed observer gain assumes that the recorded {} is not delayed, as this filter "
            "does without zero_phase: record it unfiltered or use observer: continuation",
            info(target).name));
    if (recording.initial_state == InitialState::data && !can_track)
      signals_node.error("initial_state: data needs a recorded position or velocity");
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
  const ObserverMode observer_;
  SeriesReader series_;
};

}  // namespace

Recording read_recording(const ConfigNode& node, const Rig& rig, ObserverMode observer,
                         const RecordingSources& sources) {
  return RecordingReader(rig, observer, sources).read(node);
}

std::string ignored_by_observer(const QuantityEntry& entry, ObserverMode observer,
                                const Recording& recording) {
  if (!is_ignored(entry, observer) || !recording.find(*entry.signal)) return {};
  return fmt::format(
      "a fixed observer gain assumes that the recorded {} has no {}: remove {} and {}use observer: "
      "continuation",
      entry.group, entry.quantity.symbol, entry.name,
      entry.quantity.symbol == "delay" ? "fit T_d, which delays the whole motion, or " : "");
}

}  // namespace axisfit
