#include "apps/motion_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "apps/config.h"
#include "apps/recording_file.h"
#include "apps/units.h"
#include "sim/table.h"

namespace axisfit {
namespace {

const std::vector<std::string> kTypes{"step", "levels", "sine",    "chirp",
                                      "prbs", "move",   "recorded"};

/// Reads the keys of one type of motion. Values that are wrong are reported and left at zero.
class MotionReader {
 public:
  MotionReader(const ConfigNode& root, const Rig& rig) : root_(root), map_(root), rig_(rig) {}

  MotionFile read() {
    MotionFile file;
    const auto type = map_.required("type");
    const std::size_t choice =
        type ? type->as_choice(kTypes).value_or(kTypes.size()) : kTypes.size();
    if (const auto duration = map_.required("duration"))
      file.duration = duration->as_quantity("s", 1e-3, 1e6).value_or(1.0);
    if (choice == kTypes.size()) return file;
    const std::string& name = kTypes[choice];
    if (name == "step") {
      file.motion = StepMotion{voltage("level"), value("start", "s", 0.0, 1e6, 0.0)};
    } else if (name == "levels") {
      LevelsMotion motion;
      motion.hold = value("hold", "s", 1e-4, 1e6);
      if (const auto levels = map_.required("levels"))
        if (const auto entries = levels->as_sequence()) {
          if (entries->empty()) levels->error("levels must name at least one voltage");
          for (const ConfigNode& level : *entries)
            motion.levels.push_back(
                level.as_quantity("V", -rig_.controller.limit, rig_.controller.limit)
                    .value_or(0.0));
        }
      file.motion = std::move(motion);
    } else if (name == "sine" || name == "chirp") {
      SineMotion motion;
      motion.amplitude = voltage("amplitude");
      if (name == "sine") {
        motion.from = motion.to = value("frequency", "Hz", 1e-6, 1e4);
      } else {
        motion.from = value("from", "Hz", 0.0, 1e4);
        motion.to = value("to", "Hz", 0.0, 1e4);
      }
      motion.offset = offset(motion.amplitude);
      file.motion = motion;
    } else if (name == "prbs") {
      PrbsMotion motion;
      motion.amplitude = voltage("amplitude");
      motion.bit = value("bit", "s", 1e-4, 1e6);
      motion.offset = offset(motion.amplitude);
      if (const auto seed = map_.optional("seed"))
        motion.seed = static_cast<std::uint64_t>(
            seed->as_integer(0, std::numeric_limits<std::int64_t>::max()).value_or(1));
      file.motion = motion;
    } else if (name == "move") {
      file.motion = MoveMotion{value("distance", "m", -1e3, 1e3), value("speed", "m/s", 1e-6, 1e3),
                               value("acceleration", "m/s^2", 1e-6, 1e5)};
      if (rig_.model.structure.drive == Drive::force_source)
        type->error(
            "a move needs the slave control unit, which writes a set velocity; this axis is "
            "driven by a force source, which has no set-velocity input");
      else if (rig_.model.axis.T_d >= rig_.controller.period)
        type->error("a move needs a command delay T_d below the controller's period");
    } else {
      file.motion = recorded();
    }
    map_.finish();
    return file;
  }

 private:
  double value(const char* key, std::string_view unit, double lower, double upper) {
    const auto given = map_.required(key);
    return given ? given->as_quantity(unit, lower, upper).value_or(0.0) : 0.0;
  }
  double value(const char* key, std::string_view unit, double lower, double upper,
               double standard) {
    const auto given = map_.optional(key);
    return given ? given->as_quantity(unit, lower, upper).value_or(standard) : standard;
  }
  double voltage(const char* key) {
    return value(key, "V", -rig_.controller.limit, rig_.controller.limit);
  }
  double offset(double amplitude) {
    const double room = rig_.controller.limit - std::abs(amplitude);
    return value("offset", "V", -room, room, 0.0);
  }

  /// The command column of a recording.
  RecordedMotion recorded() {
    RecordedMotion motion;
    const auto file = map_.required("file");
    const auto path = file ? file->as_string() : std::nullopt;
    const auto time = map_.required("time"), command = map_.required("command");
    if (!path || !time || !command) return motion;
    try {
      const RecordingFile data((root_.directory() / *path).lexically_normal().string());
      const auto times = read_times(data, *time), values = read_column(data, *command, "V");
      if (!times || !values) return motion;
      const double limit = rig_.controller.limit;
      const auto beyond =
          std::ranges::find_if(*values, [&](double v) { return std::abs(v) > limit; });
      if (times->size() != values->size() || times->empty())
        command->error("the time and the command must have the same number of values");
      else if (beyond != values->end())
        command->error(fmt::format(
            "{}: a command of {:.12g} V is beyond the controller's limit of {:.12g} V",
            data.where(static_cast<std::size_t>(beyond - values->begin())), *beyond, limit));
      else
        motion.schedule = schedule_from_samples(*times, *values);
    } catch (const RecordingError& error) {
      file->error(error.what());
    }
    return motion;
  }

  const ConfigNode& root_;
  ConfigMap map_;
  const Rig& rig_;
};

}  // namespace

MotionFile read_motion_file(const std::string& path, const Rig& rig) {
  Diagnostics diagnostics;
  MotionFile file;
  if (const auto root = ConfigNode::load(path, diagnostics)) file = MotionReader(*root, rig).read();
  diagnostics.throw_if_any();
  return file;
}

namespace {

/// Writes the keys of every type of motion.
class MotionWriter {
 public:
  MotionWriter(YAML::Emitter& out, double duration) : out_(out), duration_(duration) {}

  void operator()(const StepMotion& motion) {
    begin("step");
    set("level", motion.level, "V");
    set("start", motion.start, "s");
  }
  void operator()(const LevelsMotion& motion) {
    begin("levels");
    out_ << YAML::Key << "levels" << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const double level : motion.levels) out_ << with_unit(level, "V");
    out_ << YAML::EndSeq;
    set("hold", motion.hold, "s");
  }
  void operator()(const SineMotion& motion) {
    const bool chirp = motion.from != motion.to;
    begin(chirp ? "chirp" : "sine");
    set("amplitude", motion.amplitude, "V");
    set(chirp ? "from" : "frequency", motion.from, "Hz");
    if (chirp) set("to", motion.to, "Hz");
    set("offset", motion.offset, "V");
  }
  void operator()(const PrbsMotion& motion) {
    begin("prbs");
    set("amplitude", motion.amplitude, "V");
    set("bit", motion.bit, "s");
    set("offset", motion.offset, "V");
    out_ << YAML::Key << "seed" << YAML::Value << motion.seed;
  }
  void operator()(const MoveMotion& motion) {
    begin("move");
    set("distance", motion.distance, "m");
    set("speed", motion.speed, "m/s");
    set("acceleration", motion.acceleration, "m/s^2");
  }
  void operator()(const RecordedMotion&) {
    throw std::logic_error("a recorded motion cannot be written as a motion file");
  }

 private:
  void begin(const char* type) {
    out_ << YAML::Key << "type" << YAML::Value << type;
    set("duration", duration_, "s");
  }
  void set(const char* key, double value, std::string_view unit) {
    out_ << YAML::Key << key << YAML::Value << with_unit(value, unit);
  }

  YAML::Emitter& out_;
  double duration_;
};

}  // namespace

std::string format_motion_file(const MotionFile& file, const std::string& comment) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  std::visit(MotionWriter(out, file.duration), file.motion);
  out << YAML::EndMap;
  return with_comment(comment, out.c_str());
}

}  // namespace axisfit
