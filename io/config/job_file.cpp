#include "io/config/job_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <tuple>

#include "fit/data/validation.h"
#include "io/config/axis_file.h"
#include "io/config/channels.h"
#include "io/config/job_parameters.h"
#include "io/config/job_recording.h"
#include "io/config/recording_keys.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kContinuation = "continuation", kNone = "none", kWhole = "whole",
                           kAuto = "auto";

const NumberWithUnit kHorizon{"s", 1e-4, 1e6};

Section fit_keys() {
  const FitOptions defaults;
  const NumberWithUnit gain{"1/s", 1e-3, 1e6};
  return {
      Key::optional("observer",
                    AnyOf{{Choice{{{std::string(kContinuation),
                                    "high gain at first, then lower and lower, finally zero"},
                                   {std::string(kNone), "free-running from the initial values"}}},
                           Map{{Key::required("fixed", gain, "constant observer gain")}}}},
                    0,  // continuation
                    "observer that makes the simulation track the recorded velocity and position "
                    "during the fit"),
      Key::optional(
          "initial_observer_gain", gain,
          DefaultText{
              "1 / sampling interval; 0.3 / sampling interval if only the position is recorded"},
          "observer gain at which a continuation starts"),
      Key::optional(
          "horizon",
          AnyOf{{Choice{{{std::string(kWhole), "all of each recording"},
                         {std::string(kAuto),
                          "what predicts best stretches of the fitted recordings that are left "
                          "out, one step ahead among them"}}},
                 kHorizon}},
          DefaultText{"`whole`"},
          "how long the simulation runs free before it begins anew, from a state that is fitted; "
          "needs `observer: continuation` or `none`, but for `auto`"),
      Key::optional(
          "loss",
          Choice{{{"squares", "the sum of squared residuals"},
                  {"huber", "the same, but residuals beyond `huber_width` count linearly"}}},
          defaults.loss, "what is minimised"),
      Key::optional("huber_width", NumberWithUnit{"1", 0.1, 1e3}, defaults.huber_width,
                    "residual beyond which it counts linearly, in sigma; needs `loss: huber`"),
      Key::optional(
          "max_iterations", Integer{1, 100000}, defaults.max_iterations,
          "iteration limit of each stage of a continuation; at most 12 before the last stage"),
      Key::optional("starts", Integer{1, 1000000}, defaults.starts,
                    "number of starts, the first from the initial values, the others random"),
      Key::optional("spread", NumberWithUnit{"1", 1.0, 1e6}, defaults.spread,
                    "spread of the random starts: on a log scale, the factor either way"),
      Key::optional("seed", Integer{}, defaults.seed, "seed of the random starts"),
      Key::optional("step", NumberWithUnit{"s", 1e-7, 0.1}, defaults.step,
                    "longest Runge-Kutta step and longest interval between event checks")};
}

Section limit_keys(Vocabulary vocabulary) {
  const DefaultText covered{"range covered by the recordings"};
  const std::string m(unit_on(vocabulary, "m")), speed(unit_on(vocabulary, "m/s")),
      command(unit_on(vocabulary, kCommandUnit));
  return {
      Key::optional("travel", Bounds{{m}}, covered,
                    "allowed positions of the arm, such as `[0 m, 1.2 m]`"),
      Key::optional("speed",
                    NumberWithUnit{speed, 1e-6, vocabulary.joint == Joint::prismatic ? 1e3 : 1e6},
                    covered, "largest speed of the arm in either direction"),
      Key::optional("command", NumberWithUnit{command, 1e-6, 1e6},
                    DefaultText{"the controller's `limit` for an electric drive; otherwise "
                                "what the recordings covered"},
                    "largest magnitude of the command; never above the controller's `limit`"),
      Key::optional("voltage", NumberWithUnit{"V", 1e-6, 1e6}, DefaultText{"see `command`"},
                    "the same, of a command in V")};
}

class JobReader {
 public:
  JobReader(std::string path, RecordingSources sources, Files drafts = {})
      : path_(std::move(path)), sources_(std::move(sources)), drafts_(std::move(drafts)) {}

  JobFile read() {
    result_.files.push_back(path_);
    if (const auto root = load(path_)) {
      result_.text = root->contents();
      if (const std::string other = other_kind(*root); !other.empty()) {
        root->error(other);
        diagnostics_.throw_if_any();
      }
      ConfigMap map(*root, job_keys());
      const auto axis = map.required("axis");
      bool model = false;
      if (axis) model = read_axis_of(*axis);
      const auto effects = map.optional("effects");
      const auto recordings = map.required("recordings");
      Structure& structure = result_.rig.model.structure;
      const std::size_t declared = channels_of(structure).size();
      if (recordings && recordings->is_sequence())
        add_channels_of(*recordings->as_sequence(), structure);
      if (effects) read_effects(*effects, result_.rig.model);
      result_.job.axis = result_.rig.name;
      result_.job.model = result_.rig.model;
      result_.job.guessed = result_.rig.guessed;
      const auto free = map.required("free");
      if (const auto fit = map.optional("fit")) read_options(*fit);
      if (const auto limits = map.optional("limits")) read_limits(*limits);
      // What refers to the axis can only be checked with one.
      if (model && recordings) read_recordings(*recordings);
      set_channel_zeros(declared, result_.job);
      structure.channels = result_.job.model.structure.channels;
      if (model && free) read_free(*free, diagnostics_, result_.job);
      if (model) say_faults(*root);
      map.finish();
    }
    diagnostics_.throw_if_any();
    return std::move(result_);
  }

 private:
  /// The contents of a file that is yet to be written, or null.
  const std::string* draft(const std::string& path) const {
    const auto found = std::ranges::find(drafts_, path, &Files::value_type::first);
    return found == drafts_.end() ? nullptr : &found->second;
  }

  std::optional<ConfigNode> load(const std::string& path) {
    const std::string* contents = draft(path);
    return contents ? ConfigNode::parse(*contents, path, diagnostics_)
                    : ConfigNode::load(path, diagnostics_);
  }

  /// What to do with a file that is no job but one of the other kinds; empty for a job.
  static std::string other_kind(const ConfigNode& root) {
    if (!root.is_map()) return "";
    ConfigMap map(root);
    const auto has = [&](const char* key) { return map.optional(key).has_value(); };
    if (has("recordings") || has("free")) return "";
    if (has("drive") && has("parameters"))
      return "this is an axis file, not a job: name it under `axis` in a job, or create a job for "
             "it: fit-params --init RECORDING --axis FILE";
    if (has("type") && has("duration"))
      return "this is a motion file, not a job: it is for simulate-axis";
    return "";
  }

  bool read_axis_of(const ConfigNode& node) {
    const auto file = node.as_string();
    if (!file) return false;
    result_.axis_file = resolved(node, *file, {});
    result_.files.push_back(result_.axis_file);
    std::error_code unreadable;
    if (!draft(result_.axis_file) && !fs::exists(result_.axis_file, unreadable)) {
      node.error(fmt::format("axis file {} does not exist", result_.axis_file));
      return false;
    }
    const auto root = load(result_.axis_file);
    if (root && root->is_map() && ConfigMap(*root).optional("recordings")) {
      node.error(fmt::format("{} is a job file: name a file that describes an axis", *file));
      return false;
    }
    auto rig = root ? read_axis(*root, diagnostics_) : std::nullopt;
    if (!rig) return false;
    result_.axis_text = root->contents();
    result_.rig = std::move(*rig);
    return true;
  }

  void read_options(const ConfigNode& node) {
    FitOptions& options = result_.job.options;
    ConfigMap map(node, keys_below(job_keys(), "fit"));
    if (const auto observer = map.optional("observer")) read_observer(*observer, options);
    std::optional<double> start_gain;
    if (const auto gain = map.read("initial_observer_gain", start_gain)) {
      if (options.is_continued())
        options.continuation->start_gain = start_gain.value_or(0.0);
      else
        gain->error("initial_observer_gain needs observer: continuation");
    }
    if (const auto horizon = map.optional("horizon")) read_horizon(*horizon, options);
    map.read("loss", options.loss);
    if (const auto width = map.read("huber_width", options.huber_width);
        width && options.loss != Loss::huber)
      width->error("huber_width needs loss: huber");
    map.read("max_iterations", options.max_iterations);
    map.read("starts", options.starts);
    map.read("seed", options.seed);
    map.read("spread", options.spread);
    map.read("step", options.step);
    map.finish();
  }

  static void read_observer(const ConfigNode& node, FitOptions& options) {
    if (node.text() == kContinuation) return;  // the default
    if (node.text() == kNone) {
      options.continuation.reset();
    } else if (!node.is_map()) {
      node.error("observer must be continuation, none, or a fixed gain such as {fixed: 300 1/s}");
    } else {
      const auto& forms = std::get<AnyOf>(find_key(keys_below(job_keys(), "fit"), "observer").form);
      ConfigMap fixed(node, std::get<Map>(forms.forms.back()).keys);
      Tracking tracking;
      fixed.read("fixed", tracking.gain);
      options.criterion = tracking;
      fixed.finish();
    }
  }

  void read_horizon(const ConfigNode& node, FitOptions& options) {
    const std::string text = node.text();
    result_.job.choose_criterion = text == kAuto;
    if (text == kAuto || text == kWhole) return;
    if (text.find_first_of("0123456789") == std::string::npos) {
      node.error("horizon must be whole, auto, or a time with its unit, such as 2 s");
      return;
    }
    const std::optional<double> length = node.as_number_with_unit(kHorizon);
    if (tracks(options.criterion))
      node.error(
          "with a fixed observer nothing runs free: remove 'horizon', or let it be chosen with "
          "'horizon: auto'");
    else if (length)
      options.criterion = Windows{*length};
  }

  void read_limits(const ConfigNode& node) {
    MachineLimits& limits = result_.job.limits;
    const Vocabulary vocabulary = result_.job.vocabulary();
    const Section keys = limit_keys(vocabulary);
    ConfigMap map(node, keys);
    if (const auto travel = map.optional("travel"))
      if (const auto range = travel->as_bounds(unit_on(vocabulary, "m"), -kUnlimited, kUnlimited))
        std::tie(limits.lowest, limits.highest) = *range;
    map.read("speed", limits.speed);
    map.read("command", limits.command);
    if (const auto voltage = map.optional("voltage")) {
      if (limits.command || vocabulary.command != Command::voltage)
        voltage->error("the command of this axis is limited by 'command': remove 'voltage'");
      map.read("voltage", limits.command);
    }
    map.finish();
  }

  void read_recordings(const ConfigNode& node) {
    const auto entries = node.as_sequence();
    if (!entries) return;
    for (const ConfigNode& entry : *entries) {
      const std::size_t mistakes = diagnostics_.count();
      result_.job.recordings.push_back(read_recording(entry, result_.rig, sources_));
      entries_.push_back(diagnostics_.count() == mistakes ? std::optional(entry) : std::nullopt);
      const Recording& recording = result_.job.recordings.back();
      if (!sources_.tables.contains(recording.file))
        result_.files.push_back(
            file_of_recording(resolved(entry, recording.file, sources_.folder)));
    }
    result_.rig.model.structure.closed_loop = result_.job.model.structure.closed_loop =
        std::ranges::any_of(result_.job.recordings, [](const Recording& r) {
          return r.command.meaning == Meaning::reference;
        });
  }

  /// The rules that the job breaks as a whole, each at its place in the file. What was read with a
  /// mistake is not judged.
  void say_faults(const ConfigNode& root) const {
    for (const JobFault& fault : faults(result_.job)) {
      if (fault.rule == JobFault::Rule::second_free) continue;  // a duplicate key, which was said
      if (fault.recording ? entries_[*fault.recording].has_value()
                          : fault.parameter || diagnostics_.empty())
        place_of(fault, root).error(fault.message);
    }
  }

  ConfigNode place_of(const JobFault& fault, const ConfigNode& root) const {
    using Rule = JobFault::Rule;
    const Job& job = result_.job;
    if (fault.parameter) {
      const std::string& name = job.entry(job.free[*fault.parameter].quantity).name;
      const ConfigNode free = below(root, {"free", name});
      return fault.rule == Rule::sigma ? below(free, {"prior", "sigma"}) : free;
    }
    if (!fault.recording)
      return below(root, {fault.rule == Rule::fitted_recording ? "recordings"
                          : fault.rule == Rule::model          ? "axis"
                                                               : "free"});
    const ConfigNode& entry = *entries_[*fault.recording];
    if (fault.measurement) {
      const Recording& r = job.recordings[*fault.recording];
      const Signal signal = r.measurements[*fault.measurement].signal;
      const ConfigNode at = below(entry, {"signals", info(signal, job.vocabulary()).name});
      return fault.rule == Rule::sigma ? below(at, {"sigma"}) : at;
    }
    switch (fault.rule) {
      case Rule::name:
        return below(root, {"recordings"});
      case Rule::horizon:
        return below(root, {"fit", "horizon"});
      case Rule::model:
        return below(entry, {"set"});
      case Rule::unscored:
        return below(entry, {"initial_samples"});
      case Rule::gap:
      case Rule::duration:
      case Rule::same_samples:
        return entry;
      default:
        return below(entry, {"signals"});
    }
  }

  /// The value at the end of these keys, as far as they are given.
  static ConfigNode below(ConfigNode node, std::initializer_list<std::string_view> keys) {
    for (const std::string_view key : keys) {
      const auto given = node.is_map() ? ConfigMap(node).optional(key) : std::nullopt;
      if (!given) break;
      node = *given;
    }
    return node;
  }

  std::string path_;
  RecordingSources sources_;
  Files drafts_;  ///< paths and contents
  Diagnostics diagnostics_;
  /// Of the recordings, without those that cannot be judged for their mistakes.
  std::vector<std::optional<ConfigNode>> entries_;
  JobFile result_;
};

}  // namespace

const Section& job_keys() {
  static const Section keys{
      Key::required("axis", Text{}, "the axis file"),
      Key::optional(
          "effects", Map{effect_keys()}, DefaultText{"none"},
          "effects that are added to those of the axis file or replace them; same syntax"),
      Key::required("recordings", List{{Map{recording_keys()}}},
                    "the recordings; at least one must have the role `fit`"),
      Key::required("free", free_quantities(), "the quantities to fit; at least one"),
      Key::optional("fit", Map{fit_keys()}, DefaultText{"those of its keys"}, "options of the fit"),
      Key::optional("limits", Map{limit_keys(Joint::prismatic)}, DefaultText{"those of its keys"},
                    "limits of the machine for the next experiment")};
  return keys;
}

JobFile read_job_file(const std::string& path, const std::string& data_directory) {
  return JobReader(path, {data_directory, {}}).read();
}

JobFile read_job_draft(const Files& files, const std::string& folder, Tables tables) {
  Files drafts = files;
  for (auto& [name, contents] : drafts) name = (fs::path(folder) / name).lexically_normal();
  const std::string path = drafts.back().first;
  return JobReader(path, {{}, std::move(tables)}, std::move(drafts)).read();
}

const Section& axes_job_keys() {
  static const Section keys{Key::required(
      "axes", Map{{}, 2, false, {}, {{std::string(kChannelName), Text{}}}},
      "the job file of each axis of a machine, by the name of the axis; at least two")};
  return keys;
}

std::optional<AxesJob> read_axes_job(const std::string& path) {
  Diagnostics diagnostics;
  const auto root = ConfigNode::load(path, diagnostics);
  if (!root || !root->is_map() || !ConfigMap(*root).optional("axes")) return std::nullopt;
  ConfigMap map(*root, axes_job_keys());
  const auto axes = map.required("axes");
  map.finish();
  AxesJob found;
  for (ConfigMap entries(*axes); const auto& [name, job] : entries.entries()) {
    if (job.is_map()) {
      axes->error(
          "this is a machine file, which is for simulate-axis; a job of several axes has the job "
          "file of each, as in 'axes: {x: x-job.yaml, y: y-job.yaml}'");
      break;
    }
    is_plain_name(name, "an axis");  // it becomes that of a folder
    if (const auto file = job.as_string())
      found.jobs.emplace_back(name.text(), resolved(job, *file, {}));
  }
  if (axes->is_map() && diagnostics.empty() && found.jobs.size() < 2)
    axes->error("a job of several axes has at least two; for one, run its job");
  diagnostics.throw_if_any();
  return found;
}

}  // namespace axisfit
