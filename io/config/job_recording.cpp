#include "io/config/job_recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "base/units.h"
#include "fit/data/derivative.h"
#include "fit/data/noise.h"
#include "fit/data/recording_check.h"
#include "fit/data/standstill.h"
#include "fit/estimation/continuation.h"
#include "fit/estimation/initial_state.h"
#include "io/config/axis_file.h"
#include "io/config/channels.h"
#include "io/recording/csv.h"
#include "io/recording/recording_file.h"
#include "sim/controller.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

/// Of a noise, in any unit. Below this squares of residuals over it overflow.
constexpr double kMinSigma = 1e-40;

/// Of a recording.
constexpr std::size_t kLeastSamples = 10;

/// How often a value may be recorded.
constexpr std::int64_t kMostHeld = 100000;

/// Every quantity of the list, as a value that differs from the axis file's.
Section override_keys() {
  Section keys = quantity_keys();
  for (Key& key : keys) {
    key.is_required = false;
    key.default_value.clear();
    key.default_text = "value in the axis file or job";
  }
  return keys;
}

/// What a recorder did to a signal.
Section filter_keys() {
  const Filter none;
  return {Key::optional("moving_average", Integer{2, 100000}, DefaultText{"none"},
                        "mean of so many samples; odd with `zero_phase`"),
          Key::optional("butterworth",
                        Map{{Key::required("order", Integer{1, kHighestFilterOrder}, "order"),
                             Key::required("cutoff", NumberWithUnit{"Hz", 1e-6, 1e9},
                                           "where the amplitude of one pass is 1/sqrt(2)")}},
                        DefaultText{"none"}, "a Butterworth low-pass"),
          Key::optional("zero_phase", Boolean{}, none.zero_phase,
                        "`true`: without delay; the mean about each sample, or the Butterworth "
                        "filter forwards and backwards (filtfilt)")};
}

/// A column whose values may have times, or a file, of their own.
Section series_keys() {
  Section keys = column_keys();
  keys.push_back(Key::optional("file", Text{}, DefaultText{"that of the recording"},
                               "file of the column, where signals are in several"));
  keys.push_back(Key::optional("time", Map{column_keys(), 0, false, "column"},
                               DefaultText{"that of the recording"},
                               "column of the times of these values, where they have their own"));
  keys.push_back(Key::optional("offset", NumberWithUnit{"s"}, 0.0, "added to these times"));
  return keys;
}

/// V
constexpr double kLeastSupply = 1e-3, kMostSupply = 1e5;

/// How the loop around a recorded reference is closed, in the order of its words.
enum class Loop { computed, simulated };

/// What the input does between its samples.
Key input_hold_key() {
  return Key::optional("hold",
                       Choice{{{"zero_order", "keeps the first: as what is commanded"},
                               {"linear", "goes straight to the second: as what is measured"}}},
                       DefaultText{"`zero_order`; of a drive_force `linear`"},
                       "what it does between two samples");
}

/// The position that a controller was asked for.
Section reference_keys() {
  Section keys = column_keys();
  keys.push_back(input_hold_key());
  keys.push_back(Key::optional(
      "loop",
      Choice{{{"computed", "the command is computed from it and the recorded position"},
              {"simulated", "the controller is simulated with the axis"}}},
      DefaultText{"`computed` for a velocity loop, else `simulated`"}, "how the loop is closed"));
  return keys;
}

/// All signals, first those of a prismatic joint, under each name once.
std::vector<SignalInfo> signals_of_both() {
  std::vector<SignalInfo> list;
  for (const Joint joint : kJoints)
    for (const SignalInfo& of_sliding : kSignalTable) {
      const SignalInfo signal = info(of_sliding.signal, joint);
      if (std::ranges::find(list, signal.name, &SignalInfo::name) == list.end())
        list.push_back(signal);
    }
  return list;
}

/// "m or rad"
std::string units_of_both(const SignalInfo& signal) {
  const std::string_view turning = info(signal.signal, Joint::revolute).unit;
  const bool is_called_so = info(signal.signal, Joint::revolute).name == signal.name;
  return turning == signal.unit || !is_called_so ? std::string(signal.unit)
                                                 : fmt::format("{} or {}", signal.unit, turning);
}

/// The input and all that can be measured.
Section signal_keys() {
  Section input = series_keys();
  input.push_back(Key::optional("sigma", NumberWithUnit{"V", 0.0},
                                DefaultText{"estimated from the samples; 0 V for a velocity loop"},
                                "standard deviation of the noise; 0 V: the axis received exactly "
                                "these values"));
  input.push_back(input_hold_key());
  input.push_back(Key::optional(
      "supply",
      AnyOf{
          {NumberWithUnit{"V", kLeastSupply, kMostSupply}, Map{column_keys(), 0, false, "column"}}},
      DefaultText{"the column is the command itself"},
      "the column is a duty, such as 40 %, of this voltage: a number, or a column of its own"));
  Section keys{Key::optional("command", Map{std::move(input), 0, false, "input_column"},
                             DefaultText{"none if another input is given"},
                             "set-velocity voltage U, or the input of a force source, in V"),
               Key::optional("position_reference", Map{reference_keys(), 0, false, "reference"},
                             DefaultText{"not used with a command"},
                             "in m or rad, in place of the command, which the controller of the "
                             "axis file makes of it")};
  for (const SignalInfo& signal : signals_of_both()) {
    Section measured = series_keys();
    measured.push_back(Key::optional(
        "sigma",
        AnyOf{
            {sigma_form(signal.unit), Choice{{{"standstill", "scatter of the signal at standstill"},
                                              {"fit", "estimated jointly with the parameters"}}}}},
        DefaultText{"estimated from the samples"}, "standard deviation of the noise"));
    measured.push_back(Key::optional("fit", Boolean{}, Measurement().fitted,
                                     "`false`: compare and report, do not fit"));
    measured.push_back(Key::optional("filter", Map{filter_keys(), 1, false, "filter"},
                                     DefaultText{"none"},
                                     "digital filter that the samples went through before they "
                                     "were recorded; the simulated ones go through it too"));
    const Integer times{1, kMostHeld};
    constexpr const char* kMeaning =
        "how often each value is recorded (sample and hold); only the first of each counts";
    if (signal.signal == Signal::drive_force)
      measured.push_back(Key::optional("hold", AnyOf{{times, input_hold_key().form}},
                                       DefaultText{"`1`; of an input `linear`"},
                                       std::string(kMeaning) + "; of an input as of `command`"));
    else
      measured.push_back(
          Key::optional("hold", times, static_cast<double>(Measurement().hold), kMeaning));
    keys.push_back(Key::optional(std::string(signal.name),
                                 Map{std::move(measured), 0, false, "measured_column"},
                                 DefaultText{"not measured"},
                                 fmt::format("{}, in {}", signal.meaning, units_of_both(signal))));
  }
  return keys;
}

/// Columns by the names of channels.
const Map& keys_of_channels() {
  static const Map keys = [] {
    Section of_channel = series_keys();
    of_channel.push_back(Key::optional(
        "derivative", Integer{1, 2}, DefaultText{"the values themselves"},
        "the channel is the first or second derivative of the column by time, without a delay; "
        "`unit` is that of the column"));
    return Map{{},
               0,
               false,
               {},
               {{std::string(kChannelName), Map{std::move(of_channel), 0, false, "channel"}}}};
  }();
  return keys;
}

class RecordingReader {
 public:
  RecordingReader(const Rig& rig, ObserverMode observer, const RecordingSources& sources)
      : rig_(rig), observer_(observer), sources_(sources) {}

  Recording read(const ConfigNode& node) {
    Recording recording;
    ConfigMap map(node, recording_keys());
    std::optional<std::string> path;
    const auto file = map.read("file", path);
    if (path) {
      recording.file = *path;
      recording.name = fs::path(*path).stem().string();
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
    const RecordingFile* const data = path ? open(*file, *path) : nullptr;
    if (data && time && signals) read_samples(*data, *time, *signals, channels, trim, recording);
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

  /// The part of a recording that is kept, in recorded time, s.
  struct Trim {
    double from = -kUnlimited, to = kUnlimited;
    bool keeps(double time) const { return time >= from && time <= to; }
  };

  static Trim read_trim(const ConfigNode& node) {
    Trim trim;
    ConfigMap map(node, keys_below(recording_keys(), "trim"));
    map.read("from", trim.from);
    map.read("to", trim.to);
    map.finish();
    return trim;
  }

  /// The values of a signal that there are, and their times, s.
  struct Series {
    Values times, values;
    bool own_clock = false;   ///< not that of the recording
    std::size_t missing = 0;  ///< values that the recording has none of at its times
  };

  /// A measured signal before all have the same times.
  struct Measured {
    Measurement measurement;  ///< without values
    Series series;            ///< trimmed
    ConfigNode node;
    std::optional<ConfigNode> shaped;  ///< the filter or the hold
  };

  /// Null, with a diagnostic at `node`, where it cannot be read.
  const RecordingFile* open(const ConfigNode& node, const std::string& path) {
    const auto table = sources_.tables.find(path);
    const std::string found =
        table != sources_.tables.end() ? path : resolved(node, path, sources_.folder);
    if (const auto open = files_.find(found); open != files_.end()) return &open->second;
    if (table != sources_.tables.end())
      return &files_.emplace(found, RecordingFile(table->second)).first->second;
    try {
      return &files_.emplace(found, RecordingFile(found)).first->second;
    } catch (const RecordingError& error) {
      node.error(error.what());
      return nullptr;
    }
  }

  void read_samples(const RecordingFile& data, const ConfigNode& time_node,
                    const ConfigNode& signals_node, const std::optional<ConfigNode>& channels_node,
                    const std::optional<ConfigNode>& trim_node, Recording& recording) {
    data_ = &data;
    time_node_ = time_node;
    times_ = read_times(data, time_node);
    const Trim trim = trim_node ? read_trim(*trim_node) : Trim();
    ConfigMap signals(signals_node, keys_below(recording_keys(), "signals"));
    auto input = read_input(signals_node, signals, recording);
    std::vector<Measured> measured;
    const std::size_t named = read_measurements(signals, trim, measured);
    const bool all_known = signals.finish();
    std::vector<Schedule> channels;
    if (channels_node) channels = read_channels(*channels_node);
    if (!times_ || !input || times_->empty()) return;
    // Effects of the time mean that of the recording, and at 1.7e9 s a double is too coarse to
    // step on.
    constexpr double kDay = 86400.0;
    const double begin = std::abs(times_->front()) > kDay ? times_->front() : 0.0;
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
      say_too_few(trim_node, *input, measured, recording.times.size());
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

  void say_too_few(const std::optional<ConfigNode>& trim_node, const Series& input,
                   const std::vector<Measured>& measured, std::size_t left) const {
    const std::string samples = fmt::format("{} sample{}", left, left == 1 ? "" : "s");
    const bool own = std::ranges::any_of(
        measured, [&](const Measured& m) { return m.series.own_clock || input.own_clock; });
    trim_node.value_or(*time_node_)
        .error(trim_node
                   ? fmt::format(
                         "only {} of {}, from {:g} s to {:g} s, remain: at least 10 are needed",
                         samples, times_->size(), times_->front(), times_->back())
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
    if (measured.empty()) times = *times_;
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

  /// The values at the times of the recording. Where there is none, no residual counts, and a curve
  /// through those that there are takes its place in all that goes by the values.
  static Measurement on_times(Measured measured, const Values& times) {
    Measurement measurement = std::move(measured.measurement);
    const Series& series = measured.series;
    Values values(times.size(), 0.0);
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

  /// What drives the axis: a command in volts, for a force source also a recorded force, or a
  /// position reference. Nothing, with diagnostics, unless it fits the times.
  std::optional<Series> read_input(const ConfigNode& signals_node, ConfigMap& signals,
                                   Recording& recording) {
    const bool force_source = capabilities(rig_.model.structure).is_force_driven;
    const auto command = signals.optional("command");
    const SignalInfo drive_force = info(Signal::drive_force, vocabulary());
    const auto force = force_source ? signals.optional(drive_force.name) : std::nullopt;
    const auto reference = signals.optional("position_reference");
    if (command && force)
      force->error(fmt::format("give either the command or the {}, not both: each drives the axis",
                               words_on(vocabulary(), "drive force")));
    if (command && reference)
      reference->error("the recorded command drives the axis: remove position_reference");
    if (!command && !force && !reference)
      signals_node.error(
          force_source
              ? fmt::format("the axis is driven by a command or a {}: name one of them, or "
                            "the position_reference that its controller follows",
                            drive_force.name)
              : "the axis is driven by the command: name its column, or that of the "
                "position_reference that its controller follows");
    if (force && reference)
      reference->error(fmt::format("the recorded {} drives the axis: remove position_reference",
                                   words_on(vocabulary(), "force")));
    if (command && force) return std::nullopt;
    if (reference && !command) return read_reference(*reference, signals, recording);
    std::optional<Series> input;
    if (force) {
      recording.command.hold = Hold::linear;
      input = read_noisy_input(*force, drive_force.unit, recording);
      // The source turns U into the force K_f U; a force needs no gain.
      const std::size_t gain = find_quantity("K_f")->index;
      if (std::ranges::any_of(recording.overrides, [&](const auto& o) { return o.first == gain; }))
        force->error(fmt::format("a {} acts as it is: remove K_f from 'set'", drive_force.name));
      recording.overrides.emplace_back(gain, 1.0);
    } else if (command) {
      input = read_noisy_input(*command, unit_on(vocabulary(), kCommandUnit), recording);
    }
    return input;
  }

  /// Its noise is taken from its samples where it was measured, as is what drives a force source.
  std::optional<Series> read_noisy_input(const ConfigNode& node, std::string_view unit,
                                         Recording& recording) {
    ConfigMap map(node, measurement_keys("command"));
    const auto supply_node = map.optional("supply");
    std::optional<Schedule> supply;
    if (supply_node) {
      supply = read_supply(*supply_node);
      if (unit != "V")
        supply_node->error(
            "a duty of a supply makes a voltage: the drive must be one that takes V");
    }
    auto input = read_series(node, map, supply_node ? "1" : unit);
    if (supply_node && !supply) input.reset();
    if (supply && input)
      for (std::size_t i = 0; i < input->values.size(); ++i)
        input->values[i] *= supply->value_at(input->times[i]);
    if (const auto sigma = map.optional("sigma")) {
      recording.command_sigma = sigma->as_number_with_unit({std::string(unit), 0.0}).value_or(0.0);
    } else if (input && capabilities(rig_.model.structure).is_direct()) {
      recording.command_sigma = noise_of_input(input->values);
      recording.command_noise = NoiseSource::differences;
    }
    map.read("hold", recording.command.hold);
    map.finish();
    return input;
  }

  /// The voltage of a supply over the time. Nothing, with diagnostics, where it is not known.
  std::optional<Schedule> read_supply(const ConfigNode& node) const {
    Schedule supply;
    supply.hold = Hold::linear;
    if (!node.is_map()) {
      const auto volts = node.as_quantity("V", kLeastSupply, kMostSupply);
      if (!volts) return std::nullopt;
      supply.append(0.0, *volts);
      return supply;
    }
    ConfigMap map(node, column_keys());
    const auto volts = read_column(*data_, map, "V");
    map.finish();
    if (!volts || !times_ || !same_length(node, *volts, *times_)) return std::nullopt;
    for (std::size_t i = 0; i < volts->size(); ++i)
      if (!std::isnan((*volts)[i]) && !std::isnan((*times_)[i]))
        supply.append((*times_)[i], (*volts)[i]);
    if (!supply.times.empty()) return supply;
    node.error("the supply has no values");
    return std::nullopt;
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
    const Section& keys = std::get<Map>(keys_of_channels().named.front().form).keys;
    for (const Channel& channel : *rig_.model.structure.channels) {
      const auto given = map.required(channel.name);
      if (!given) continue;
      ConfigMap column(*given, keys);
      int order = 0;
      column.read("derivative", order);
      if (auto series = read_series(*given, column, integrated(channel.unit, order))) {
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

  /// A column and its times, without what is missing. Nothing, with diagnostics, where something is
  /// wrong.
  std::optional<Series> read_series(const ConfigNode& node, ConfigMap& map, std::string_view unit) {
    std::optional<std::string> path;
    const auto file = map.read("file", path);
    const auto time = map.optional("time");
    Series series;
    double offset = 0.0;
    map.read("offset", offset);
    const RecordingFile* const data = path ? open(*file, *path) : data_;
    if (data == nullptr) return std::nullopt;
    const auto values = read_column(*data, map, unit);
    series.own_clock = path || time || offset != 0.0;
    const auto times = path || time ? read_times(*data, time.value_or(*time_node_)) : times_;
    if (!values || !times) return std::nullopt;
    if (values->size() != times->size()) {
      node.error(fmt::format("{} has {} values but the time has {}", node.name(), values->size(),
                             times->size()));
      return std::nullopt;
    }
    for (std::size_t i = 0; i < times->size(); ++i) {
      if (std::isnan((*times)[i]) || std::isnan((*values)[i])) continue;
      series.times.push_back((*times)[i] + offset);
      series.values.push_back((*values)[i]);
    }
    const auto timed = std::ranges::count_if(*times, [](double t) { return !std::isnan(t); });
    if (!series.own_clock) series.missing = static_cast<std::size_t>(timed) - series.times.size();
    // Whether the recording is too short altogether is said once, for all signals.
    if (series.times.size() >= kLeastSamples || times->size() < kLeastSamples) return series;
    node.error(fmt::format("{} has only {} values with a time: at least 10 are needed", node.name(),
                           series.times.size()));
    return std::nullopt;
  }

  static const Section& measurement_keys(std::string_view signal) {
    return keys_below(keys_below(recording_keys(), "signals"), signal);
  }

  /// The reference for the controller of the axis file, or the command that this makes of it.
  std::optional<Series> read_reference(const ConfigNode& node, ConfigMap& signals,
                                       Recording& recording) const {
    const std::string_view unit = info(Signal::position, vocabulary()).unit;
    ConfigMap map(node, measurement_keys("position_reference"));
    const auto reference = read_column(*data_, map, unit);
    std::optional<Loop> loop;
    map.read("loop", loop);
    Hold hold = Hold::zero_order;
    map.read("hold", hold);
    map.finish();
    const bool is_direct = capabilities(rig_.model.structure).is_direct();
    if (!reference || !times_ || !same_length(node, *reference, *times_)) return std::nullopt;
    const auto is_complete = [&](const ConfigNode& of, const Values& values) {
      const auto is_missing = [](double x) { return std::isnan(x); };
      const bool complete =
          std::ranges::none_of(values, is_missing) && std::ranges::none_of(*times_, is_missing);
      if (!complete)
        of.error(fmt::format(
            "the controller needs the {} at every sample, and some are missing: trim the "
            "recording or fill the gaps",
            &of == &node ? "reference" : "position"));
      return complete;
    };
    if (!is_complete(node, *reference)) return std::nullopt;
    if (loop.value_or(is_direct ? Loop::simulated : Loop::computed) == Loop::simulated) {
      recording.command.meaning = Meaning::reference;
      recording.command.hold = hold;
      return Series{*times_, *reference};
    }
    const auto position_node = signals.optional("position");
    if (!position_node) {
      node.error(
          "to compute the command of a position_reference the controller reads the encoder: name "
          "its column under position, or say 'loop: simulated'");
      return std::nullopt;
    }
    ConfigMap position_map(*position_node, measurement_keys("position"));
    const auto position = read_column(*data_, position_map, unit);
    if (!position || !same_length(*position_node, *position, *times_)) return std::nullopt;
    if (!is_complete(*position_node, *position)) return std::nullopt;
    const Controller<double>& controller = rig_.model.controller;
    const Schedule track{*times_, *reference, Hold::linear};
    const auto at = [&](double t) { return track.value_at(times_->front() + t); };
    return Series{*times_, command_from_reference(controller, *times_,
                                                  track_points(controller.timing, at), *position)};
  }

  /// All signals but the input. Returns how many were named, rightly or wrongly.
  std::size_t read_measurements(ConfigMap& signals, const Trim& trim,
                                std::vector<Measured>& measured) {
    const Structure& structure = rig_.model.structure;
    std::size_t named = 0;
    for (const SignalInfo& of_sliding : kSignalTable) {
      const SignalInfo signal = info(of_sliding.signal, vocabulary());
      const bool is_input =
          signal.signal == Signal::drive_force && capabilities(structure).is_force_driven;
      const auto given = is_input ? std::nullopt : signals.optional(signal.name);
      if (!given) continue;
      ++named;
      if (!has_signal(signal.signal, structure)) {
        given->error(fmt::format("the drive of this axis has no {}: remove it", signal.name));
        continue;
      }
      if (auto found = read_measurement(*given, signal, trim))
        measured.push_back(std::move(*found));
    }
    return named;
  }

  std::optional<Measured> read_measurement(const ConfigNode& node, const SignalInfo& signal,
                                           const Trim& trim) {
    ConfigMap map(node, measurement_keys(signal.name));
    Measurement measurement;
    measurement.signal = signal.signal;
    auto series = read_series(node, map, signal.unit);
    if (series) keep(trim, *series);
    map.read("fit", measurement.fitted);
    const auto hold = map.optional("hold");
    if (hold)
      measurement.hold = static_cast<std::size_t>(hold->as_integer(1, kMostHeld).value_or(1));
    const auto filter = map.optional("filter");
    if (filter)
      measurement.filter = read_filter(*filter, sampling(series ? series->times : Values()));
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

  /// From the values as they follow each other in the recording.
  static void take_noise(const ConfigNode& node, const Series& series,
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

  static void keep(const Trim& trim, Series& series) {
    Series kept{{}, {}, series.own_clock, series.missing};
    for (std::size_t i = 0; i < series.times.size(); ++i) {
      if (!trim.keeps(series.times[i])) continue;
      kept.times.push_back(series.times[i]);
      kept.values.push_back(series.values[i]);
    }
    series = std::move(kept);
  }

  /// None where anything is wrong, with a diagnostic, or without enough samples.
  static Filter read_filter(const ConfigNode& node, const Sampling& sampling) {
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

  /// Leaves the samples that a filter or a hold leaves, with a diagnostic where that cannot be.
  static void prepare(const ConfigNode& node, const std::string& signal, Measurement& measurement) {
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

  static bool same_length(const ConfigNode& node, const std::vector<double>& values,
                          const std::vector<double>& times) {
    if (values.size() == times.size()) return true;
    node.error(fmt::format("{} has {} values but the time has {}", node.name(), values.size(),
                           times.size()));
    return false;
  }

  Vocabulary vocabulary() const { return vocabulary_of(rig_.model.structure); }

  const Rig& rig_;
  const ObserverMode observer_;
  const RecordingSources& sources_;
  std::map<std::string, RecordingFile> files_;  ///< read already, by path
  const RecordingFile* data_ = nullptr;         ///< of the recording
  std::optional<ConfigNode> time_node_;
  std::optional<Values> times_;  ///< s, NaN where there is none
};

}  // namespace

const Section& recording_keys() {
  const Recording defaults;
  static const Section keys{
      Key::required("file", Text{},
                    "recording: text (CSV, also `.gz`), `.mat`, `.mcap` or `.xlsx`"),
      Key::optional("name", Text{}, DefaultText{"file name without folder and extension"},
                    "name in reports; unique within the job"),
      Key::optional(
          "role",
          Choice{{{"fit", "its residuals are minimised"}, {"validate", "for validation only"}}},
          defaults.role, "how it is used"),
      Key::required("time", Map{column_keys(), 0, false, "column"},
                    "column of the sample times, which must increase"),
      Key::required("signals", Map{signal_keys()}, "columns of the input and the measured signals"),
      Key::optional("channels", keys_of_channels(), DefaultText{"none"},
                    "columns of what else was recorded and may act on the axis, such as "
                    "`{temperature: {column: T_motor, unit: degC}}`"),
      Key::optional("trim",
                    Map{{Key::optional("from", NumberWithUnit{"s"}, DefaultText{"the first sample"},
                                       "start of the part to keep, inclusive"),
                         Key::optional("to", NumberWithUnit{"s"}, DefaultText{"the last sample"},
                                       "end of the part to keep, inclusive")}},
                    DefaultText{"all samples"}, "part to keep, in recorded time"),
      Key::optional("initial_state",
                    Choice{{{"given", "as in the axis file"}, {"data", "from the first samples"}}},
                    defaults.initial_state, "initial state"),
      Key::optional("initial_samples", Integer{4, 1000000}, defaults.initial_samples,
                    "number of samples that `initial_state: data` uses"),
      Key::optional("score_initial_samples", Boolean{}, defaults.score_initial_samples,
                    "`false`: exclude the initial samples from the reported errors"),
      Key::optional("acceleration_at_standstill",
                    Choice{{{"exclude", "not used"}, {"keep", "used"}}},
                    defaults.acceleration_at_standstill, "recorded acceleration at standstill"),
      Key::optional("set",
                    Map{override_keys(),
                        0,
                        false,
                        {},
                        {{std::string(kChannelQuantity), amount_per_channel()}}},
                    DefaultText{"none"},
                    "quantities that differ in this recording, such as "
                    "`{M: 161 kg, initial.y0: 20 mm}`")};
  return keys;
}

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

std::string resolved(const ConfigNode& node, const std::string& file, const std::string& base) {
  const fs::path given(file);
  if (given.is_absolute()) return file;
  return (base.empty() ? node.directory() / given : fs::path(base) / given)
      .lexically_normal()
      .string();
}

NumberWithUnit sigma_form(std::string_view unit) {
  return {std::string(unit), 0.0, kUnlimited,
          is_dimensionless(unit) ? "number above 0" : "above 0, with its unit"};
}

double read_sigma(const ConfigNode& node, std::string_view unit) {
  const auto sigma = node.as_number_with_unit(sigma_form(unit));
  if (sigma && *sigma < kMinSigma)
    node.error("sigma must be above zero: residuals are divided by it");
  return sigma.value_or(1.0);
}

}  // namespace axisfit
