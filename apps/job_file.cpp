#include "apps/job_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <set>
#include <tuple>

#include "apps/axis_file.h"
#include "apps/job_free.h"
#include "apps/job_recording.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

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
      if (model && free) read_free(*free, result_.job);
      map.finish();
    }
    diagnostics_.throw_if_any();
    return std::move(result_);
  }

 private:
  bool read_axis(const ConfigNode& node) {
    const auto file = node.as_string();
    if (!file) return false;
    result_.axis_file = resolved(node, *file, {});
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
      result_.job.recordings.push_back(
          read_recording(entry, result_.rig, result_.job.options.coupling, data_directory_));
      any_fit = any_fit || result_.job.recordings.back().role == Role::fit;
    }
    for (const Recording& recording : result_.job.recordings)
      if (!names.insert(recording.name).second)
        node.error(fmt::format("two recordings are called '{}': give them different names",
                               recording.name));
    if (!any_fit && diagnostics_.empty())
      node.error("no recording has the role fit: at least one must");
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
