#include "io/config/job_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>
#include <tuple>

#include "io/config/axis_file.h"
#include "io/config/job_parameters.h"
#include "io/config/job_recording.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kContinuation = "continuation", kNone = "none";

Section fit_keys() {
  const FitOptions standard;
  const Amount rate{"1/s", 1e-3, 1e6};
  return {
      Key::optional(
          "coupling",
          Either{{Choice{{{std::string(kContinuation),
                           "firmly at first, then ever more loosely, at last free"},
                          {std::string(kNone), "free running from the initial values"}}},
                  Map{{Key::required("fixed", rate, "held at this rate to the end")}}}},
          CouplingMode::continuation,
          "how the simulation is held to the recorded velocity and position while it is fitted"),
      Key::optional("first_coupling", rate,
                    Otherwise{"one per sampling interval; 0.3 for the position alone"},
                    "where a continuation starts"),
      Key::optional("loss",
                    Choice{{{"squares", "of the residuals"},
                            {"huber", "residuals beyond `huber_width` count linearly"}}},
                    standard.loss, "what is minimised"),
      Key::optional("huber_width", Amount{"1", 0.1, 1e3}, standard.huber_width,
                    "residual from which on it counts linearly, in sigma; needs `loss: huber`"),
      Key::optional("max_iterations", Whole{1, 100000}, standard.max_iterations,
                    "of each stage of a continuation; stages before the last end at 12"),
      Key::optional("starts", Whole{1, 1000000}, standard.starts,
                    "number of starts, the first from the initial values, the others random"),
      Key::optional("spread", Amount{"1", 1.0, 1e6}, standard.spread,
                    "of the random starts, on a log scale the factor either way"),
      Key::optional("seed", Whole{}, standard.seed, "of the random starts"),
      Key::optional("step", Amount{"s", 1e-7, 0.1}, standard.step,
                    "longest Runge-Kutta step; of a simulation held to the data, longest time "
                    "between two looks for events")};
}

Section limit_keys() {
  const Otherwise covered{"what the recordings covered"};
  return {
      Key::optional("travel", Bounds{{"m"}}, covered,
                    "range of the arm's position, such as `[0 m, 1.2 m]`"),
      Key::optional("speed", Amount{"m/s", 1e-6, 1e3}, covered, "largest of the arm, either way"),
      Key::optional(
          "voltage", Amount{"V", 1e-6, 1e6},
          Otherwise{"of an electric drive the controller's `limit`; else what the "
                    "recordings covered"},
          "largest of the command, either way; never more than the controller's `limit`")};
}

class JobReader {
 public:
  JobReader(const std::string& path, const std::string& data_directory, const Files& drafts = {})
      : path_(path), data_directory_(data_directory), drafts_(drafts) {}

  JobFile read() {
    if (const auto root = load(path_)) {
      result_.text = root->contents();
      ConfigMap map(*root, job_keys());
      const auto axis = map.required("axis");
      bool model = false;
      if (axis) model = read_axis_of(*axis);
      if (const auto effects = map.optional("effects")) read_effects(*effects, result_.rig.model);
      result_.job.axis = result_.rig.name;
      result_.job.model = result_.rig.model;
      result_.job.controller = result_.rig.controller;
      const auto recordings = map.required("recordings");
      const auto free = map.required("free");
      if (const auto fit = map.optional("fit")) read_options(*fit);
      if (const auto limits = map.optional("limits")) read_limits(*limits);
      // What refers to the axis can only be checked with one.
      if (model && recordings) read_recordings(*recordings);
      if (model && free) read_free(*free, result_.job);
      if (free && diagnostics_.empty()) check_freedom(*free);
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

  bool read_axis_of(const ConfigNode& node) {
    const auto file = node.as_string();
    if (!file) return false;
    result_.axis_file = resolved(node, *file, {});
    std::error_code unreadable;
    if (!draft(result_.axis_file) && !fs::exists(result_.axis_file, unreadable)) {
      node.error(fmt::format("there is no axis file {}", result_.axis_file));
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
    if (const auto coupling = map.optional("coupling")) read_coupling(*coupling, options);
    std::optional<double> first_rate;
    if (const auto rate = map.read("first_coupling", first_rate)) {
      if (options.coupling == CouplingMode::continuation)
        options.coupling_rate = first_rate.value_or(0.0);
      else
        rate->error(
            "first_coupling is where a continuation starts: it needs coupling: continuation");
    }
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

  static void read_coupling(const ConfigNode& node, FitOptions& options) {
    if (node.text() == kContinuation) {
      options.coupling = CouplingMode::continuation;
    } else if (node.text() == kNone) {
      options.coupling = CouplingMode::none;
    } else if (!node.is_map()) {
      node.error("coupling must be continuation, none, or for example {fixed: 300 1/s}");
    } else {
      const auto& forms =
          std::get<Either>(find_key(keys_below(job_keys(), "fit"), "coupling").form);
      ConfigMap fixed(node, std::get<Map>(forms.forms.back()).keys);
      options.coupling = CouplingMode::fixed;
      fixed.read("fixed", options.coupling_rate);
      fixed.finish();
    }
  }

  void read_limits(const ConfigNode& node) {
    MachineLimits& limits = result_.job.limits;
    ConfigMap map(node, keys_below(job_keys(), "limits"));
    if (const auto travel = map.optional("travel"))
      if (const auto range = travel->as_bounds("m", -kUnlimited, kUnlimited))
        std::tie(limits.lowest, limits.highest) = *range;
    map.read("speed", limits.speed);
    map.read("voltage", limits.voltage);
    map.finish();
  }

  void read_recordings(const ConfigNode& node) {
    const auto entries = node.as_sequence();
    if (!entries) return;
    bool any_fit = false;
    std::set<std::string> names;
    for (const ConfigNode& entry : *entries) {
      result_.job.recordings.push_back(
          read_recording(entry, result_.rig, result_.job.options.coupling, data_directory_));
      any_fit = any_fit || result_.job.recordings.back().role == Role::fit;
      check_length(entry, result_.job.recordings.back());
    }
    for (const Recording& recording : result_.job.recordings)
      if (!names.insert(recording.name).second)
        node.error(fmt::format("two recordings are called '{}': give them different names",
                               recording.name));
    if (!any_fit && diagnostics_.empty())
      node.error("no recording has the role fit: at least one must");
  }

  /// Whether there is more to fit to than parameters.
  void check_freedom(const ConfigNode& node) const {
    std::size_t values = 0, parameters = result_.job.free.size();
    for (const Recording& r : result_.job.recordings)
      for (const Measurement& m : r.measurements)
        for (std::size_t i = 0; i < m.values.size(); ++i) values += r.fits(m, i);
    for (const FreeParameter& p : result_.job.free) values += p.prior.has_value();
    if (values <= parameters)
      node.error(
          fmt::format("{} values, priors included, do not determine {} parameters: fit "
                      "fewer, or to more samples",
                      values, parameters));
  }

  /// What takes so many steps is a mistake in the times, or would be fitted for days.
  void check_length(const ConfigNode& node, const Recording& recording) const {
    constexpr double kStepsBetweenSamples = 1e6, kSteps = 1e8;
    const std::vector<double>& times = recording.times;
    const double step = result_.job.options.step;
    if (times.size() < 2) return;
    std::size_t longest = 1;
    for (std::size_t i = 2; i < times.size(); ++i)
      if (times[i] - times[i - 1] > times[longest] - times[longest - 1]) longest = i;
    const double gap = times[longest] - times[longest - 1], all = times.back() - times.front();
    if (gap > kStepsBetweenSamples * step)
      node.error(fmt::format(
          "'{}' has no sample for {:.6g} s, from {:.9g} s on: trim it to one side of that; or is "
          "the unit of the time wrong?",
          recording.name, gap, times[longest - 1]));
    else if (all > kSteps * step)
      node.error(fmt::format(
          "'{}' lasts {:.6g} s: too long to be simulated in steps of {:g} s; trim it, or give fit "
          "a longer step; or is the unit of the time wrong?",
          recording.name, all, step));
  }

  std::string path_;
  std::string data_directory_;
  Files drafts_;  ///< paths and contents
  Diagnostics diagnostics_;
  JobFile result_;
};

}  // namespace

const Section& job_keys() {
  static const Section keys{
      Key::required("axis", Text{}, "the axis file"),
      Key::optional("effects", Map{keys_below(axis_keys(), "effects")}, Otherwise{"none"},
                    "effects to add to those of the axis file, or to replace; written as there"),
      Key::required("recordings", List{{Map{recording_keys()}}},
                    "what was recorded; at least one must have the role `fit`"),
      Key::required("free", Map{free_quantities(), 1}, "the quantities to fit; at least one"),
      Key::optional("fit", Map{fit_keys()}, Otherwise{"that of each key"}, "how to fit"),
      Key::optional("limits", Map{limit_keys()}, Otherwise{"that of each key"},
                    "what the machine allows in the next experiment")};
  return keys;
}

JobFile read_job_file(const std::string& path, const std::string& data_directory) {
  return JobReader(path, data_directory).read();
}

JobFile read_job_draft(const Files& files, const std::string& folder) {
  Files drafts = files;
  for (auto& [name, contents] : drafts) name = (fs::path(folder) / name).lexically_normal();
  return JobReader(drafts.back().first, {}, drafts).read();
}

}  // namespace axisfit
