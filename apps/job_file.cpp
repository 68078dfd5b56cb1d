#include "apps/job_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <ranges>
#include <set>
#include <tuple>

#include "apps/axis_file.h"
#include "apps/recording_file.h"
#include "apps/units.h"
#include "fit/initial_state.h"
#include "fit/noise.h"
#include "fit/rest.h"
#include "sim/table.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// "0.56 ohm", for messages.
std::string rounded(double value, std::string_view unit) {
  return with_unit(fmt::format("{:g}", value), unit);
}

class JobReader {
 public:
  JobReader(const std::string& path, const std::string& data_directory)
      : path_(path), data_directory_(data_directory) {}

  JobFile read() {
    if (const auto root = ConfigNode::load(path_, diagnostics_)) {
      ConfigMap map(*root);
      const auto axis = map.required("axis");
      bool model = false;
      if (axis) model = read_axis(*axis);
      if (const auto effects = map.optional("effects")) read_effects(*effects, result_.rig.model);
      result_.job.model = result_.rig.model;
      const auto recordings = map.required("recordings");
      const auto free = map.required("free");
      if (const auto fit = map.optional("fit")) read_options(*fit);
      if (const auto limits = map.optional("limits")) read_limits(*limits);
      // What refers to the axis can only be checked with one.
      if (model && recordings) read_recordings(*recordings);
      if (model && free) read_free(*free);
      map.finish();
    }
    diagnostics_.throw_if_any();
    return std::move(result_);
  }

 private:
  static std::string resolve(const ConfigNode& node, const std::string& file,
                             const std::string& base) {
    const fs::path given(file);
    if (given.is_absolute()) return file;
    return (base.empty() ? node.directory() / given : fs::path(base) / given)
        .lexically_normal()
        .string();
  }

  bool read_axis(const ConfigNode& node) {
    const auto file = node.as_string();
    if (!file) return false;
    result_.axis_file = resolve(node, *file, {});
    std::error_code unreadable;
    if (!fs::exists(result_.axis_file, unreadable)) {
      node.error(fmt::format("there is no axis file {}", result_.axis_file));
      return false;
    }
    auto rig = read_axis_file(result_.axis_file, diagnostics_);
    if (!rig) return false;
    result_.rig = std::move(*rig);
    return true;
  }

  void read_options(const ConfigNode& node) {
    FitOptions& options = result_.job.options;
    ConfigMap map(node);
    if (const auto coupling = map.optional("coupling")) {
      if (coupling->text() == "continuation") {
        options.coupling = CouplingMode::continuation;
      } else if (coupling->text() == "none") {
        options.coupling = CouplingMode::none;
      } else if (!coupling->is_map()) {
        coupling->error("coupling must be continuation, none, or for example {fixed: 300 1/s}");
      } else {
        ConfigMap fixed(*coupling);
        options.coupling = CouplingMode::fixed;
        if (const auto rate = fixed.required("fixed"))
          options.coupling_rate = rate->as_quantity("1/s", 1e-3, 1e6).value_or(1.0);
        fixed.finish();
      }
    }
    if (const auto rate = map.optional("first_coupling")) {
      if (options.coupling == CouplingMode::continuation)
        options.coupling_rate = rate->as_quantity("1/s", 1e-3, 1e6).value_or(0.0);
      else
        rate->error(
            "first_coupling is where a continuation starts: it needs coupling: continuation");
    }
    if (const auto loss = map.optional("loss")) {
      static const std::vector<std::string> losses{"squares", "huber"};
      options.loss = static_cast<Loss>(loss->as_choice(losses).value_or(0));
    }
    if (const auto width = map.optional("huber_width")) {
      options.huber_width = width->as_number(0.1, 1e3).value_or(3.0);
      if (options.loss != Loss::huber) width->error("huber_width needs loss: huber");
    }
    const auto integer = [&](const char* key, std::int64_t lower, std::int64_t upper, auto& value) {
      if (const auto given = map.optional(key))
        if (const auto read = given->as_integer(lower, upper))
          value = static_cast<std::remove_reference_t<decltype(value)>>(*read);
    };
    integer("max_iterations", 1, 100000, options.max_iterations);
    integer("starts", 1, 1000000, options.starts);
    integer("seed", 0, std::numeric_limits<std::int64_t>::max(), options.seed);
    if (const auto spread = map.optional("spread"))
      options.spread = spread->as_number(1.0, 1e6).value_or(5.0);
    if (const auto step = map.optional("step"))
      options.step = step->as_quantity("s", 1e-7, 0.1).value_or(options.step);
    map.finish();
  }

  void read_limits(const ConfigNode& node) {
    MachineLimits& limits = result_.limits;
    ConfigMap map(node);
    if (const auto travel = map.optional("travel"))
      if (const auto range = travel->as_bounds("m", -kUnlimited, kUnlimited))
        std::tie(limits.lowest, limits.highest) = *range;
    if (const auto speed = map.optional("speed"))
      limits.speed = speed->as_quantity("m/s", 1e-6, 1e3);
    if (const auto voltage = map.optional("voltage"))
      limits.voltage = voltage->as_quantity("V", 1e-6, 1e6);
    map.finish();
  }

  void read_recordings(const ConfigNode& node) {
    const auto entries = node.as_sequence();
    if (!entries) return;
    bool any_fit = false;
    std::set<std::string> names;
    for (const ConfigNode& entry : *entries) {
      read_recording(entry);
      if (result_.job.recordings.empty()) continue;
      const Recording& latest = result_.job.recordings.back();
      any_fit = any_fit || latest.role == Role::fit;
    }
    for (const Recording& recording : result_.job.recordings)
      if (!names.insert(recording.name).second)
        node.error(fmt::format("two recordings are called '{}': give them different names",
                               recording.name));
    if (!any_fit && diagnostics_.empty())
      node.error("no recording has the role fit: at least one must");
  }

  void read_recording(const ConfigNode& node) {
    Recording recording;
    ConfigMap map(node);
    const auto file = map.required("file");
    std::optional<std::string> path;
    if (file) path = file->as_string();
    if (path) {
      recording.file = *path;
      recording.name = fs::path(*path).stem().string();
    }
    if (const auto name = map.optional("name"))
      recording.name = name->as_string().value_or(recording.name);
    if (const auto role = map.optional("role")) {
      static const std::vector<std::string> roles{"fit", "validate"};
      recording.role = static_cast<Role>(role->as_choice(roles).value_or(0));
    }
    if (const auto state = map.optional("initial_state")) {
      static const std::vector<std::string> states{"given", "data"};
      recording.initial_state = static_cast<InitialState>(state->as_choice(states).value_or(0));
    }
    const auto initial_samples = map.optional("initial_samples");
    if (const auto& n = initial_samples)
      recording.initial_samples = static_cast<std::size_t>(n->as_integer(4, 1000000).value_or(20));
    if (const auto rest = map.optional("acceleration_at_rest")) {
      static const std::vector<std::string> choices{"leave_out", "keep"};
      recording.acceleration_at_rest = rest->as_choice(choices).value_or(0) == 1;
    }
    if (const auto score = map.optional("score_initial_samples"))
      recording.score_initial_samples = score->as_bool().value_or(true);
    if (const auto set = map.optional("set")) read_overrides(*set, recording);
    const auto time = map.required("time");
    const auto signals = map.required("signals");
    const auto trim = map.optional("trim");
    std::optional<RecordingFile> data;
    if (path) {
      try {
        data.emplace(resolve(*file, *path, data_directory_));
      } catch (const RecordingError& error) {
        file->error(error.what());
      }
    }
    if (data && time && signals) read_samples(*data, *time, *signals, trim, recording);
    if (!recording.score_initial_samples && recording.times.size() >= 10 &&
        recording.initial_samples >= recording.times.size())
      initial_samples.value_or(node).error(
          fmt::format("{} initial samples that are not scored leave nothing of {} to score",
                      recording.initial_samples, recording.times.size()));
    map.finish();
    result_.job.recordings.push_back(std::move(recording));
  }

  void read_overrides(const ConfigNode& node, Recording& recording) {
    ConfigMap map(node);
    for (const auto& [key, value] : map.entries())
      if (const QuantityEntry* entry = quantity_named(key, result_.rig.model.structure))
        if (const auto given = read_value(value, entry->quantity))
          recording.overrides.emplace_back(entry->index, *given);
    map.finish();
    Model<double> model = result_.rig.model;
    for (const auto& [index, value] : recording.overrides) *members(model)[index] = value;
    if (const std::string reason = refusal(model); !reason.empty()) node.error(reason);
  }

  using Values = std::vector<double>;

  /// The part of a recording that is kept, in recorded time, s.
  struct Trim {
    double from = -kUnlimited, to = kUnlimited;
    bool keeps(double time) const { return time >= from && time <= to; }
  };

  static Trim read_trim(const ConfigNode& node) {
    Trim trim;
    ConfigMap map(node);
    if (const auto t = map.optional("from"))
      trim.from = t->as_quantity("s", -kUnlimited, kUnlimited).value_or(trim.from);
    if (const auto t = map.optional("to"))
      trim.to = t->as_quantity("s", -kUnlimited, kUnlimited).value_or(trim.to);
    map.finish();
    return trim;
  }

  static Values trimmed(const Values& values, const Values& times, const Trim& trim) {
    Values kept;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (trim.keeps(times[i])) kept.push_back(values[i]);
    return kept;
  }

  void read_samples(const RecordingFile& data, const ConfigNode& time_node,
                    const ConfigNode& signals_node, const std::optional<ConfigNode>& trim_node,
                    Recording& recording) {
    const auto times = read_times(data, time_node);
    const Trim trim = trim_node ? read_trim(*trim_node) : Trim();
    ConfigMap signals(signals_node);
    const auto input = read_input(data, signals_node, signals, times, recording);
    const bool any_named = read_measurements(data, signals, times, trim, recording);
    signals.finish();
    if (!times || !input) return;
    // Commands from before the first sample kept still act on it.
    Values command_times, commands;
    for (std::size_t i = 0; i < times->size() && (*times)[i] <= trim.to; ++i) {
      command_times.push_back((*times)[i]);
      commands.push_back((*input)[i]);
    }
    recording.command = schedule_from_samples(command_times, commands);
    recording.times = trimmed(*times, *times, trim);
    if (recording.times.size() < 10) {
      trim_node.value_or(time_node).error(
          fmt::format("{} samples are too few: at least 10 must be left", recording.times.size()));
      recording.times = {0.0, 1.0};
      return;
    }
    check_samples(signals_node, any_named, recording);
    take_noise_from_rest(signals_node, recording);
    if (recording.initial_state == InitialState::data) initial_state_from_data(recording);
    if (!recording.acceleration_at_rest) leave_out_acceleration_at_rest(recording);
  }

  /// What drives the axis: a command in volts, for a force source also a recorded force, or a
  /// position reference. Nothing, with diagnostics, unless it fits the times.
  std::optional<Values> read_input(const RecordingFile& data, const ConfigNode& signals_node,
                                   ConfigMap& signals, const std::optional<Values>& times,
                                   Recording& recording) {
    const bool force_source = result_.rig.model.structure.drive == Drive::force_source;
    const auto command = signals.optional("command");
    const auto force = force_source ? signals.optional("drive_force") : std::nullopt;
    const auto reference = force_source ? std::nullopt : signals.optional("position_reference");
    if (command && force)
      force->error("give either the command or the drive force, not both: each drives the axis");
    if (command && reference)
      reference->error("the command is recorded and drives the axis: remove the reference");
    if (!command && !force && !reference)
      signals_node.error(force_source
                             ? "the axis is driven by a command or a drive_force: name one "
                               "of them"
                             : "the axis is driven by the command: name its column, or that of the "
                               "position_reference, from which the slave control unit makes it");
    if (command && force) return std::nullopt;
    if (reference && !command) return read_reference(data, *reference, signals, times);
    std::optional<Values> input;
    if (force) {
      input = read_column(data, *force, "N");
      // The source turns U into K_f U newtons; a force in newtons needs no gain.
      const std::size_t gain = find_quantity("K_f")->index;
      if (std::ranges::any_of(recording.overrides, [&](const auto& o) { return o.first == gain; }))
        force->error("a drive_force is in newtons already: remove K_f from 'set'");
      recording.overrides.emplace_back(gain, 1.0);
    } else if (command) {
      input = read_column(data, *command, "V");
    }
    if (input && times && !same_length(force ? *force : *command, *input, *times)) input.reset();
    return input;
  }

  /// The command that the axis file's slave control unit makes of a recorded position reference.
  std::optional<Values> read_reference(const RecordingFile& data, const ConfigNode& node,
                                       ConfigMap& signals,
                                       const std::optional<Values>& times) const {
    const auto reference = read_column(data, node, "m");
    const auto position_node = signals.optional("position");
    if (!position_node) {
      node.error(
          "a position_reference drives the slave control unit, which reads the encoder: name "
          "the column of the position too");
      return std::nullopt;
    }
    ConfigMap map(*position_node);
    const auto position = read_column(data, map, "m");
    if (!reference || !position || !times) return std::nullopt;
    if (!same_length(node, *reference, *times) || !same_length(*position_node, *position, *times))
      return std::nullopt;
    return command_from_reference(result_.rig.controller, *times, *reference, *position);
  }

  /// All signals but the input. Returns whether any was named, rightly or wrongly.
  bool read_measurements(const RecordingFile& data, ConfigMap& signals,
                         const std::optional<Values>& times, const Trim& trim,
                         Recording& recording) {
    const Structure& structure = result_.rig.model.structure;
    bool any_named = false;
    for (const SignalInfo& signal : kSignalTable) {
      const bool is_input =
          signal.signal == Signal::drive_force && structure.drive == Drive::force_source;
      const auto given = is_input ? std::nullopt : signals.optional(signal.name);
      if (!given) continue;
      any_named = true;
      if (!has_signal(signal.signal, structure)) {
        given->error(fmt::format("the drive of this axis has no {}: remove it", signal.name));
        continue;
      }
      auto measurement = read_measurement(data, *given, signal, times, trim);
      if (measurement) recording.measurements.push_back(std::move(*measurement));
    }
    return any_named;
  }

  static std::optional<Measurement> read_measurement(const RecordingFile& data,
                                                     const ConfigNode& node,
                                                     const SignalInfo& signal,
                                                     const std::optional<Values>& times,
                                                     const Trim& trim) {
    ConfigMap map(node);
    Measurement measurement;
    measurement.signal = signal.signal;
    const auto values = read_column(data, map, signal.unit);
    if (const auto fit = map.optional("fit")) measurement.fitted = fit->as_bool().value_or(true);
    if (const auto sigma = map.optional("sigma")) {
      if (sigma->text() == "fit") {
        measurement.noise = NoiseSource::fit;
      } else if (sigma->text() == "rest") {
        measurement.noise = NoiseSource::rest;
      } else {
        measurement.sigma = read_sigma(*sigma, signal.unit);
        measurement.noise = NoiseSource::given;
      }
    }
    map.finish();
    if (!values || !times || !same_length(node, *values, *times)) return std::nullopt;
    measurement.values = trimmed(*values, *times, trim);
    if (measurement.noise != NoiseSource::given) {
      measurement.sigma = noise_from_differences(measurement.values);
      if (!(measurement.sigma > 0.0))
        node.error(
            fmt::format("the noise of {} cannot be estimated from these samples: give its "
                        "sigma, for example 'sigma: {}'",
                        signal.name, rounded(0.01, signal.unit)));
    }
    return measurement;
  }

  /// Whether the recording has what its role and the options of the fit need.
  void check_samples(const ConfigNode& signals_node, bool any_named,
                     const Recording& recording) const {
    const bool held = recording.find(Signal::position) || recording.find(Signal::velocity);
    if (!any_named)
      signals_node.error(
          fmt::format("nothing to compare with: name at least one of {}",
                      fmt::join(kSignalTable | std::views::transform(&SignalInfo::name), ", ")));
    else if (recording.role == Role::fit && !recording.measurements.empty() &&
             std::ranges::none_of(recording.measurements, &Measurement::fitted))
      signals_node.error(
          "nothing to fit: every signal says fit: false; drop that from one, or give "
          "the recording the role validate");
    if (result_.job.options.coupling == CouplingMode::fixed && !held)
      signals_node.error("a fixed coupling needs a recorded position or velocity");
    if (recording.initial_state == InitialState::data && !held)
      signals_node.error("initial_state: data needs a recorded position or velocity");
  }

  static void take_noise_from_rest(const ConfigNode& signals_node, Recording& recording) {
    for (Measurement& m : recording.measurements) {
      if (m.noise != NoiseSource::rest) continue;
      if (const double noise = noise_at_rest(recording, m); noise > 0.0)
        m.sigma = noise;
      else
        signals_node.error(fmt::format(
            "the arm does not rest for 50 samples in this recording, or no velocity or position "
            "shows it: give the sigma of {}, or leave it out",
            info(m.signal).name));
    }
  }

  static bool same_length(const ConfigNode& node, const std::vector<double>& values,
                          const std::vector<double>& times) {
    if (values.size() == times.size()) return true;
    node.error(fmt::format("{} has {} values but the time has {}", node.name(), values.size(),
                           times.size()));
    return false;
  }

  static double read_sigma(const ConfigNode& node, std::string_view unit) {
    const auto sigma = node.as_quantity(unit, 0.0, kUnlimited);
    if (sigma == 0.0) node.error("sigma must be above zero: residuals are divided by it");
    return sigma.value_or(1.0);
  }

  void read_free(const ConfigNode& node) {
    ConfigMap map(node);
    for (const auto& [key, value] : map.entries())
      if (const QuantityEntry* entry = quantity_named(key, result_.rig.model.structure))
        read_free_parameter(value, *entry);
    map.finish();
    if (node.is_map() && map.entries().empty())
      node.error("nothing is free: name at least one quantity to fit");
  }

  void read_free_parameter(const ConfigNode& node, const QuantityEntry& entry) {
    const Quantity& quantity = entry.quantity;
    FreeParameter parameter;
    parameter.quantity = entry.index;
    parameter.initial = *members(result_.job.model)[entry.index];
    std::optional<std::pair<double, double>> bounds;
    std::optional<std::size_t> scale;
    bool per_recording = false, initial_given = false;
    // "M:" alone is as good as "M: {}".
    Diagnostics none;
    ConfigMap map(node.is_null() ? *ConfigNode::parse("{}", node.file(), none) : node);
    if (const auto initial = map.optional("initial")) {
      initial_given = true;
      parameter.initial = read_value(*initial, quantity).value_or(parameter.initial);
    }
    if (const auto given = map.optional("bounds"))
      bounds = given->as_bounds(quantity.unit, quantity.lower, quantity.upper);
    if (const auto given = map.optional("scale")) {
      static const std::vector<std::string> scales{"log", "linear"};
      scale = given->as_choice(scales);
    }
    if (const auto given = map.optional("per_recording"))
      per_recording = given->as_bool().value_or(false);
    if (const auto given = map.optional("prior")) {
      ConfigMap prior(*given);
      parameter.prior.emplace();
      if (const auto mean = prior.required("mean"))
        parameter.prior->mean = read_value(*mean, quantity).value_or(0.0);
      if (const auto sigma = prior.required("sigma"))
        parameter.prior->sigma = read_sigma(*sigma, quantity.unit);
      prior.finish();
    }
    map.finish();

    // What has no zero in its range, or is part of every axis, is estimated by its order of
    // magnitude; frictions, biases, delays and initial states may be zero and are not.
    const bool positive = entry.group.empty() && quantity.standard != 0.0 && quantity.lower >= 0.0;
    parameter.logarithmic =
        scale ? *scale == 0 : (bounds ? bounds->first > 0.0 : positive && parameter.initial > 0.0);
    const auto add = [&](double initial, std::optional<std::size_t> recording) {
      FreeParameter p = parameter;
      p.initial = initial;
      p.recording = recording;
      p.lower = bounds ? bounds->first : quantity.lower;
      p.upper = bounds ? bounds->second : quantity.upper;
      if (!bounds && p.logarithmic) {
        p.lower = std::max(p.lower, initial / 100.0);
        p.upper = std::min(p.upper, initial * 100.0);
      }
      if (p.logarithmic && !(p.lower > 0.0 && p.initial > 0.0))
        node.error(
            fmt::format("{} on a logarithmic scale needs an initial value and a lower bound "
                        "above zero",
                        entry.name));
      else if (p.initial < p.lower || p.initial > p.upper)
        node.error(fmt::format("the initial value {} of {} lies outside its bounds, {} to {}",
                               rounded(p.initial, quantity.unit), entry.name,
                               rounded(p.lower, quantity.unit), rounded(p.upper, quantity.unit)));
      for (const Recording& r : result_.job.recordings)
        for (const auto& [index, value] : r.overrides)
          if (!p.recording && index == p.quantity && entry.group != "initial")
            node.error(entry.name == "K_f"
                           ? fmt::format("K_f cannot be fitted to '{}', whose drive_force is in "
                                         "newtons already",
                                         r.name)
                           : fmt::format("{} is fitted for all recordings but set for '{}': remove "
                                         "one, or say per_recording: true",
                                         entry.name, r.name));
      result_.job.free.push_back(p);
    };
    if (!per_recording) {
      add(parameter.initial, std::nullopt);
      return;
    }
    for (std::size_t r = 0; r < result_.job.recordings.size(); ++r) {
      const Recording& recording = result_.job.recordings[r];
      if (recording.role != Role::fit) continue;
      double initial = parameter.initial;
      if (!initial_given)
        for (const auto& [index, value] : recording.overrides)
          if (index == entry.index) initial = value;
      add(initial, r);
    }
  }

  std::string path_;
  std::string data_directory_;
  Diagnostics diagnostics_;
  JobFile result_;
};

}  // namespace

JobFile read_job_file(const std::string& path, const std::string& data_directory) {
  return JobReader(path, data_directory).read();
}

}  // namespace axisfit
