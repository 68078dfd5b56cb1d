#include "io/config/motion_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/units.h"
#include "io/config/config.h"
#include "io/config/recording_column.h"
#include "io/recording/csv.h"
#include "sim/controller.h"

namespace axisfit {
namespace {

/// A command up to the controller's limit, which the keys do not know.
NumberWithUnit command_up_to(const std::string& limit, Vocabulary vocabulary) {
  const std::string unit(unit_on(vocabulary, kCommandUnit));
  return {unit, -kUnlimited, kUnlimited, unit + ", +-" + limit};
}

struct MotionType {
  std::string name;
  std::string meaning;
  Section keys;
};

std::vector<MotionType> make_types(Vocabulary vocabulary) {
  const NumberWithUnit limited = command_up_to("limit", vocabulary);
  const auto offset_key = [&](double default_value) {
    return Key::optional("offset", command_up_to("(limit - amplitude)", vocabulary), default_value,
                         "mean command");
  };
  const NumberWithUnit frequency{"Hz", 0.0, 1e4};
  const auto amount = [&](const char* unit, double lower, double upper) {
    const Quantity on = quantity_on(vocabulary, {"", unit, "", lower, upper});
    return NumberWithUnit{std::string(on.unit), on.lower, on.upper};
  };
  return {
      {"step",
       "one level from a given time on",
       {Key::required("level", limited, "the command"),
        Key::optional("start", NumberWithUnit{"s", 0.0, 1e6}, StepMotion().start,
                      "time of the step")}},
      {"levels",
       "a sequence of levels",
       {Key::required("levels", List{{limited}}, "commands, the first from time zero"),
        Key::required("hold", NumberWithUnit{"s", 1e-4, 1e6}, "duration of each level")}},
      {"sine",
       "a sine of constant frequency",
       {Key::required("amplitude", limited, "amplitude of the command about the offset"),
        Key::required("frequency", NumberWithUnit{"Hz", 1e-6, 1e4}, "frequency of the sine"),
        offset_key(SineMotion().offset)}},
      {"chirp",
       "a sine whose frequency changes linearly",
       {Key::required("amplitude", limited, "amplitude of the command about the offset"),
        Key::required("from", frequency, "frequency at time zero"),
        Key::required("to", frequency, "frequency at the end of `duration`"),
        offset_key(SineMotion().offset)}},
      {"prbs",
       "a pseudo-random binary sequence",
       {Key::required("amplitude", limited, "amplitude of the command about the offset"),
        Key::required("bit", NumberWithUnit{"s", 1e-4, 1e6},
                      "bit period: how long each value is held"),
        offset_key(PrbsMotion().offset),
        Key::optional("seed", Integer{}, PrbsMotion().seed,
                      "seed of the sequence, which is the same on every machine")}},
      {"move",
       "a position move under closed-loop control",
       {Key::required("distance", amount("m", -1e3, 1e3),
                      std::string(words_on(vocabulary, "distance of the arm from position zero"))),
        Key::required("speed", amount("m/s", 1e-6, 1e3), "maximum speed"),
        Key::required("acceleration", amount("m/s^2", 1e-6, 1e5),
                      "acceleration and deceleration")}},
      {"recorded",
       "the command from a recording",
       {Key::required("file", Text{},
                      "CSV or `.mat` file; a relative path is relative to the motion file"),
        Key::required("time", Map{column_keys()},
                      "column of the sample times, which must increase"),
        Key::required("command", Map{column_keys()},
                      "column of the command; all values within the limit")}}};
}

const std::vector<MotionType>& motion_types(Vocabulary vocabulary) {
  static const auto types = for_all_vocabularies(make_types);
  return types[index_of(vocabulary)];
}

/// But for the limits, which every axis has.
bool is_standard(const ControllerGains<double>& gains) {
  bool is_all = true;
  visit_gains(gains, [&](const Quantity& quantity, double value) {
    is_all = is_all && (quantity.symbol.ends_with("limit") || value == quantity.default_value);
  });
  return is_all;
}

/// Reads the keys of one type of motion. Values that are wrong are reported.
class MotionReader {
 public:
  MotionReader(const ConfigNode& root, const Rig& rig)
      : root_(root), map_(root, motion_keys()), rig_(rig) {}

  MotionFile read() {
    MotionFile file;
    std::optional<std::size_t> choice;
    const auto type = map_.read("type", choice);
    map_.read("duration", file.duration);
    if (!choice) return file;
    const auto& [name, meaning, keys] = motion_types(vocabulary_of(rig_.model.structure))[*choice];
    map_.describe(keys);
    if (name == "step") {
      StepMotion motion;
      motion.level = level_of("level", limit());
      map_.read("start", motion.start);
      file.motion = motion;
    } else if (name == "levels") {
      LevelsMotion motion;
      map_.read("hold", motion.hold);
      if (const auto levels = map_.required("levels"))
        if (const auto entries = levels->as_sequence()) {
          if (entries->empty()) levels->error("levels must have at least one command");
          for (const ConfigNode& entry : *entries) {
            const std::optional<double> level = entry.as_quantity(unit(), -limit(), limit());
            // What is wrong with the first, as its unit, is wrong with all.
            if (!level && motion.levels.empty()) break;
            motion.levels.push_back(level.value_or(0.0));
          }
        }
      file.motion = std::move(motion);
    } else if (name == "sine" || name == "chirp") {
      SineMotion motion;
      motion.amplitude = level_of("amplitude", limit());
      if (name == "sine") {
        map_.read("frequency", motion.from);
        motion.to = motion.from;
      } else {
        map_.read("from", motion.from);
        map_.read("to", motion.to);
      }
      motion.offset = level_of("offset", limit() - std::abs(motion.amplitude));
      file.motion = motion;
    } else if (name == "prbs") {
      PrbsMotion motion;
      motion.amplitude = level_of("amplitude", limit());
      map_.read("bit", motion.bit);
      motion.offset = level_of("offset", limit() - std::abs(motion.amplitude));
      map_.read("seed", motion.seed);
      file.motion = motion;
    } else if (name == "move") {
      MoveMotion motion;
      map_.read("distance", motion.distance);
      map_.read("speed", motion.speed);
      map_.read("acceleration", motion.acceleration);
      file.motion = motion;
      const Controller<double>& controller = rig_.model.controller;
      if (!capabilities(rig_.model.structure).is_electric && is_standard(controller.gains))
        type->error(
            "a move needs a controller: its standard gains are those of a set-velocity "
            "input, which the drive of this axis does not have; give 'controller' in the "
            "axis file");
      else if (whole_periods(controller.timing, rig_.model.axis.T_d).first > kMostPeriodsLate)
        type->error(
            fmt::format("a move needs a command delay T_d below {} periods of the "
                        "controller's commands",
                        kMostPeriodsLate + 1));
    } else {
      file.motion = recorded(file.recording);
    }
    map_.finish();
    return file;
  }

 private:
  double limit() const { return rig_.model.controller.gains.limit; }

  std::string_view unit() const {
    return unit_on(vocabulary_of(rig_.model.structure), kCommandUnit);
  }

  double level_of(const char* key, double most) {
    const auto given = map_.given(key);
    return given ? given->as_quantity(unit(), -most, most).value_or(0.0) : 0.0;
  }

  /// The command column of a recording, and the path of that.
  RecordedMotion recorded(std::string& found) {
    RecordedMotion motion;
    const auto file = map_.required("file");
    const auto path = file ? file->as_string() : std::nullopt;
    const auto time = map_.required("time"), command = map_.required("command");
    if (!path || !time || !command) return motion;
    try {
      found = (root_.directory() / *path).lexically_normal().string();
      const RecordingFile data(found);
      const auto times = read_times(data, *time), values = read_column(data, *command, unit());
      if (!times || !values) return motion;
      const auto beyond =
          std::ranges::find_if(*values, [&](double v) { return std::abs(v) > limit(); });
      const auto missing = [](double x) { return std::isnan(x); };
      if (std::ranges::any_of(*times, missing) || std::ranges::any_of(*values, missing))
        command->error("the time or the command has gaps: every row needs both");
      else if (times->size() != values->size() || times->empty())
        command->error("the time and the command must have the same number of values");
      else if (beyond != values->end())
        command->error(
            fmt::format("{}: a command of {:.12g} {} exceeds the controller's limit of {:.12g} {}",
                        data.where(static_cast<std::size_t>(beyond - values->begin())), *beyond,
                        unit(), limit(), unit()));
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

const Section& motion_keys() {
  static const Section keys = [] {
    Choice types;
    for (const MotionType& type : motion_types(kSourceVocabulary))
      types.options.push_back({type.name, type.meaning});
    return Section{
        Key::required("type", types, "type of motion; the other keys depend on it"),
        Key::required("duration", NumberWithUnit{"s", 1e-3, 1e6}, "duration of the recording")};
  }();
  return keys;
}

const Section& motion_keys(const std::string& type, Vocabulary vocabulary) {
  return std::ranges::find(motion_types(vocabulary), type, &MotionType::name)->keys;
}

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
  MotionWriter(YAML::Emitter& out, double duration, Vocabulary vocabulary)
      : out_(out), duration_(duration), vocabulary_(vocabulary) {}

  void operator()(const StepMotion& motion) {
    begin("step");
    set("level", motion.level);
    set("start", motion.start);
  }
  void operator()(const LevelsMotion& motion) {
    begin("levels");
    out_ << YAML::Key << "levels" << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const double level : motion.levels)
      out_ << with_unit(level, unit_on(vocabulary_, kCommandUnit));
    out_ << YAML::EndSeq;
    set("hold", motion.hold);
  }
  void operator()(const SineMotion& motion) {
    const bool chirp = motion.from != motion.to;
    begin(chirp ? "chirp" : "sine");
    set("amplitude", motion.amplitude);
    set(chirp ? "from" : "frequency", motion.from);
    if (chirp) set("to", motion.to);
    set("offset", motion.offset);
  }
  void operator()(const PrbsMotion& motion) {
    begin("prbs");
    set("amplitude", motion.amplitude);
    set("bit", motion.bit);
    set("offset", motion.offset);
    out_ << YAML::Key << "seed" << YAML::Value << motion.seed;
  }
  void operator()(const MoveMotion& motion) {
    begin("move");
    set("distance", motion.distance);
    set("speed", motion.speed);
    set("acceleration", motion.acceleration);
  }
  void operator()(const RecordedMotion&) {
    throw std::logic_error("a recorded motion cannot be written as a motion file");
  }

 private:
  void begin(const char* type) {
    out_ << YAML::Key << "type" << YAML::Value << type;
    keys_ = &motion_keys();
    set("duration", duration_);
    keys_ = &motion_keys(type, vocabulary_);
  }
  void set(const char* key, double value) {
    const std::string& unit = std::get<NumberWithUnit>(find_key(*keys_, key).form).unit;
    out_ << YAML::Key << key << YAML::Value << with_unit(value, unit);
  }

  YAML::Emitter& out_;
  double duration_;
  Vocabulary vocabulary_;
  const Section* keys_ = nullptr;
};

}  // namespace

std::string format_motion_file(const MotionFile& file, const std::string& comment,
                               Vocabulary vocabulary) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  std::visit(MotionWriter(out, file.duration, vocabulary), file.motion);
  out << YAML::EndMap;
  return with_comment(comment, out.c_str());
}

}  // namespace axisfit
