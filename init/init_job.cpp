#include "init/init_job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "base/plain_text.h"
#include "base/rounding.h"
#include "base/units.h"
#include "base/version.h"
#include "fit/data/noise.h"
#include "fit/data/recording_check.h"
#include "fit/design/forecast.h"
#include "fit/estimation/estimate.h"
#include "init/force_balance.h"
#include "init/recording_guess.h"
#include "init/starter_axis.h"
#include "io/config/axis_file.h"
#include "io/config/job_file.h"
#include "io/config/yaml_text.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kJobName = "job.yaml";
constexpr const char* kAxisName = "axis.yaml";
constexpr std::size_t kMostSamplesToTry = 50000;  ///< of recordings that short fits are made to
constexpr double kRoom = 0.01;  ///< s, of the delay between two clocks, to either side
constexpr const char* kOnlyRatios = "a motion shows only ratios to it";

/// The line by which editors find the schema that the Debian package installs.
std::string modeline(std::string_view kind) {
  return fmt::format("# yaml-language-server: $schema=/usr/share/axisfit/schema/{}.schema.json\n",
                     kind);
}

std::string scalar(const std::string& text) {
  YAML::Emitter out;
  out << text;
  return out.c_str();
}

/// "{column: time_s, unit: s}"
std::string column_map(const GuessedColumn& column, const std::string& unit,
                       const std::pair<std::string, std::string>& more = {},
                       const std::string& file = {}, double offset = 0.0) {
  YAML::Emitter out;
  out << YAML::Flow << YAML::BeginMap << YAML::Key << "column" << YAML::Value << column.column
      << YAML::Key << "unit" << YAML::Value << unit;
  if (column.factor != 1.0)
    out << YAML::Key << "factor" << YAML::Value << fmt::format("{:.10g}", column.factor);
  if (column.overflow.signed_bits > 0)
    out << YAML::Key << "signed_bits" << YAML::Value << column.overflow.signed_bits;
  if (column.overflow.wraps_after > 0.0)
    out << YAML::Key << "wraps_after" << YAML::Value
        << fmt::format("{:.15g}", column.overflow.wraps_after);
  if (column.negative) out << YAML::Key << "sign" << YAML::Value << "-1";
  if (!file.empty()) out << YAML::Key << "file" << YAML::Value << file;
  if (!column.clock.empty())
    out << YAML::Key << "time" << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key
        << "column" << YAML::Value << column.clock << YAML::Key << "unit" << YAML::Value
        << column.clock_unit << YAML::EndMap;
  if (offset != 0.0)
    out << YAML::Key << "offset" << YAML::Value << with_unit(round_to_digits(offset, 6), "s");
  if (!more.first.empty()) out << YAML::Key << more.first << YAML::Value << more.second;
  out << YAML::EndMap;
  return out.c_str();
}

/// The signal that a kind is measured as.
std::optional<Signal> signal_of(Kind kind) {
  switch (kind) {
    case Kind::position:
      return Signal::position;
    case Kind::velocity:
      return Signal::velocity;
    case Kind::acceleration:
      return Signal::acceleration;
    case Kind::tachometer:
      return Signal::tachometer;
    case Kind::current:
      return Signal::motor_current;
    case Kind::preamplifier_voltage:
      return Signal::preamplifier_voltage;
    case Kind::motor_voltage:
      return Signal::motor_voltage;
    case Kind::force:
      return Signal::drive_force;
    default:
      return std::nullopt;
  }
}

/// What drives a recording: the key in the job, and the column.
struct Input {
  const char* key = "command";
  Kind kind = Kind::command;
  bool is_setpoint = false;
  double gain = 1.0;  ///< by which the column's values are multiplied besides
};

// What a force source may be driven by, the nearest to a force first.
const std::vector<Input> kForceInputs{
    {"drive_force", Kind::force, false},   {"drive_force", Kind::force, true},
    {"command", Kind::current, false},     {"command", Kind::current, true},
    {"command", Kind::command, false},     {"command", Kind::motor_voltage, false},
    {"command", Kind::set_velocity, false}};

/// What a velocity loop is driven by. A position that is asked for counts only where the controller
/// is known, which makes the command of it.
std::optional<Input> velocity_input(const RecordingGuess& recording, bool known_controller) {
  for (const Kind kind : {Kind::set_velocity, Kind::command})
    if (recording.find(kind)) return Input{"command", kind};
  if (recording.find(Kind::velocity, true))
    return Input{"command", Kind::velocity, true, ControllerGains<double>().gain};
  if (known_controller && recording.find(Kind::position, true) && recording.find(Kind::position))
    return Input{"position_reference", Kind::position, true};
  return std::nullopt;
}

/// What a motor is driven by, of which voltage and position controller are known.
std::optional<Input> voltage_input(const RecordingGuess& recording) {
  if (recording.find(Kind::motor_voltage)) return Input{"command", Kind::motor_voltage};
  if (recording.find(Kind::position, true) && recording.find(Kind::position))
    return Input{"position_reference", Kind::position, true};
  if (recording.find(Kind::command)) return Input{"command", Kind::command};
  return std::nullopt;
}

bool has_input(const RecordingGuess& recording, const Input& input) {
  return recording.find(input.kind, input.is_setpoint) != nullptr;
}

bool has_changing_input(const RecordingGuess& recording, const Input& input) {
  const GuessedColumn* column = recording.find(input.kind, input.is_setpoint);
  return column != nullptr && !column->is_constant();
}

/// Whether only a velocity loop has such columns. A velocity that is asked for is that of any
/// drive, where a force or a current was recorded, too: then that drives a mass, whatever controls
/// it.
bool is_of_velocity_loop(const RecordingGuess& recording) {
  return velocity_input(recording, false) &&
         (recording.find(Kind::tachometer) || recording.find(Kind::preamplifier_voltage) ||
          std::ranges::none_of(kForceInputs, [&](const Input& input) {
            return input.kind != Kind::set_velocity && has_input(recording, input);
          }));
}

struct Source {
  std::string name, file;  ///< as the job has them
  RecordingGuess guess;
  std::optional<Input> input;
  std::string input_file = {};  ///< of what drives the axis, where it is not `file`
  double input_offset = 0.0;    ///< s, added to the times of that
  /// Whether the motion goes better with the other hold than what its kind suggests.
  bool has_other_hold = false;
};

/// A quantity that the job may free.
struct Candidate {
  std::string name, entry;
  std::string reason_not_free = {};  ///< why it is not free; empty where it is
};

class Initialiser {
 public:
  Initialiser(const std::string& axis, bool is_machine, const std::string& folder,
              std::optional<double> gain, const std::vector<ColumnAnswer>& answers)
      : axis_(axis), is_machine_(is_machine), folder_(folder), gain_(gain), answers_(answers) {}

  InitialJob make(const std::vector<std::string>& paths) {
    if (!axis_.empty()) read_structure();
    for (auto path = paths.begin(); path != paths.end(); ++path) {
      std::error_code ignored;
      if (std::any_of(paths.begin(), path, [&](const std::string& earlier) {
            return std::filesystem::equivalent(earlier, *path, ignored);
          }))
        throw std::runtime_error(
            fmt::format("{} is given twice: a recording counts once", sanitized(*path)));
      add(*path);
    }
    check_answers();
    join_files();
    if (axis_.empty()) choose_drive();
    for (Source& source : sources_) write_units(source.guess, vocabulary());
    choose_inputs();
    drop_recordings_without_input();
    correct_signs();
    drop_idle_velocities();
    if (axis_.empty()) start_axis();
    list_candidates();
    choose_free();
    if (axis_.empty() || is_machine_) try_timing();
    collect_guesses();
    return {files(), std::move(guesses_)};
  }

 private:
  /// Of the axis that was named.
  void read_structure() {
    Diagnostics diagnostics;
    if (is_machine_) take_machine();
    const auto rig =
        is_machine_ ? read_axis(*ConfigNode::parse(axis_text_, kAxisName, diagnostics), diagnostics)
                    : read_axis_file(axis_, diagnostics);
    diagnostics.throw_if_any();
    structure_ = rig->model.structure;
  }

  /// Its axis file, without the line for editors, which says where the schema is.
  void take_machine() {
    const auto machine = std::ranges::find(machine_axes(), axis_, &MachineAxis::name);
    if (machine == machine_axes().end())
      throw std::runtime_error(fmt::format("there is no machine '{}': choose one of {}",
                                           sanitized(axis_), fmt::join(machine_names(), ", ")));
    std::string_view text = machine->text;
    if (text.starts_with("# yaml-language-server")) text.remove_prefix(text.find('\n') + 1);
    axis_text_ = text;
  }

  /// From the folder of the job, unless that climbs through half of the disk.
  std::string relative(const std::string& path) const {
    const fs::path near = fs::proximate(fs::absolute(path), fs::absolute(folder_));
    const bool far = near.generic_string().starts_with("../../../");
    return (far ? fs::absolute(path) : near).lexically_normal().generic_string();
  }

  /// For the user's eye, what the files mark: a column of several recordings once.
  void collect_guesses() {
    std::set<std::string> seen;
    for (const Source& source : sources_) {
      const auto list_guess = [&](const GuessedColumn& c) {
        if (!c.guessed) return;
        if (seen.insert(c.column).second)
          guesses_.push_back(
              sanitized(fmt::format("{}: {}", c.column, fmt::join(c.reasons, "; "))));
      };
      list_guess(source.guess.time);
      for (const GuessedColumn& c : source.guess.columns)
        if (is_measured(c) || &c == &input_of(source)) list_guess(c);
      for (const std::string& name : source.guess.constant)
        if (seen.insert(name).second)
          guesses_.push_back(sanitized(name + ": not used, for it never changes"));
    }
  }

  static const GuessedColumn& input_of(const Source& source) {
    return *source.guess.find(source.input->kind, source.input->is_setpoint);
  }

  /// Whether the job compares the model with the column, unless it drives it.
  bool is_measured(const GuessedColumn& c) const {
    const auto signal = signal_of(c.kind);
    return signal && !c.idle && !c.is_setpoint && !c.is_constant() &&
           has_signal(*signal, structure_) && !(force_source() && c.kind == Kind::force);
  }

  void add(const std::string& path) {
    Source source{fs::path(path).stem().string(),
                  relative(path),
                  guess_recording(RecordingFile(path), path, answers_, structure_.joint),
                  {}};
    for (int n = 2; std::ranges::count(sources_, source.name, &Source::name) > 0; ++n)
      source.name = fmt::format("{}-{}", fs::path(path).stem().string(), n);
    sources_.push_back(std::move(source));
  }

  /// Every answer is about a column that is there.
  void check_answers() const {
    for (const ColumnAnswer& answer : answers_) {
      const auto found = [&](const GuessedColumn& c) { return c.answer == answer.column; };
      if (std::ranges::none_of(sources_, [&](const Source& s) {
            return found(s.guess.time) || std::ranges::any_of(s.guess.columns, found);
          }))
        throw std::runtime_error(
            fmt::format("--column: no recording has a column '{}'; those of {} are {}",
                        sanitized(answer.column), sanitized(sources_.front().guess.path),
                        fmt::join(names_of(sources_.front()), ", ")));
    }
  }

  static std::vector<std::string> names_of(const Source& source) {
    std::vector<std::string> names{source.guess.time.column};
    for (const GuessedColumn& c : source.guess.columns) names.push_back(c.column);
    for (const std::string& name : source.guess.unused)
      names.push_back(name + (std::ranges::count(source.guess.constant, name) > 0
                                  ? " (never changes)"
                                  : " (not recognised)"));
    for (std::string& name : names) name = sanitized(name);
    return names;
  }

  static bool moves(const RecordingGuess& recording) {
    return recording.find(Kind::position) || recording.find(Kind::velocity) ||
           recording.find(Kind::acceleration);
  }

  /// Two files of which one has what drives the axis, and the other how it moved, are one
  /// recording. Their clocks need not have begun together: the force goes best with the
  /// acceleration where they agree.
  void join_files() {
    if (sources_.size() != 2) return;
    const auto driver = std::ranges::find_if(sources_, [](const Source& s) {
      return !moves(s.guess) && std::ranges::any_of(kForceInputs, [&](const Input& input) {
        return has_input(s.guess, input);
      });
    });
    const auto motion = std::ranges::find_if(sources_, [](const Source& s) {
      return moves(s.guess) && std::ranges::none_of(kForceInputs, [&](const Input& input) {
               return has_input(s.guess, input);
             });
    });
    if (driver == sources_.end() || motion == sources_.end()) return;
    const auto input = std::ranges::find_if(
        kForceInputs, [&](const Input& i) { return has_input(driver->guess, i); });
    GuessedColumn column = *driver->guess.find(input->kind, input->is_setpoint);
    const GuessedColumn& clock = driver->guess.time;
    const double offset = best_offset(*motion, clock.values, column.values);
    motion->input_file = driver->file;
    motion->input_offset = offset;
    column.clock = clock.column;
    column.clock_unit = clock.unit;
    column.values = at_times(motion->guess.time.values, clock.values, column.values, offset);
    column.reasons.push_back(
        fmt::format("from {}, whose clock was set {:.6g} s {}: there the force goes best with the "
                    "acceleration; the delay T_d, which is free, does the rest",
                    driver->name, std::abs(offset), offset < 0.0 ? "back" : "forward"));
    column.guessed = true;
    motion->guess.columns.push_back(std::move(column));
    joined_ = true;
    sources_.erase(driver);
  }

  /// Values of another clock at these times; each holds until the next.
  static std::vector<double> at_times(const std::vector<double>& times,
                                      const std::vector<double>& clock,
                                      const std::vector<double>& values, double offset) {
    std::vector<double> result;
    for (const double t : times) {
      const auto next = std::ranges::upper_bound(clock, t - offset) - clock.begin();
      result.push_back(values[static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - 1, 0))]);
    }
    return result;
  }

  static double best_offset(const Source& motion, const std::vector<double>& clock,
                            const std::vector<double>& values) {
    const RecordingGuess& guess = motion.guess;
    const GuessedColumn *position = guess.find(Kind::position),
                        *velocity = guess.find(Kind::velocity);
    const std::vector<double> none;
    const std::vector<double>& times = guess.time.values;
    const auto agreement = [&](double offset) {
      const auto balance =
          force_balance(times, position ? position->values : none,
                        velocity ? velocity->values : none, at_times(times, clock, values, offset));
      return balance ? std::abs(balance->correlation) : 0.0;
    };
    // As if both began together, and from there half of the shorter one to either side, in steps
    // that become finer.
    double best = times.front() - clock.front();
    double step = 0.5 * std::min(times.back() - times.front(), clock.back() - clock.front()) / 50.0;
    double found = agreement(best);
    for (int range = 50; step > 1e-4; range = 10, step /= 5.0) {
      const double middle = best;
      for (int k = -range; k <= range; ++k)
        if (const double here = agreement(middle + k * step); here > found) {
          found = here;
          best = middle + k * step;
        }
    }
    return best;
  }

  /// By what the first recording has of a kind that only one drive makes.
  void choose_drive() {
    const RecordingGuess& first = sources_.front().guess;
    const bool loop = is_of_velocity_loop(first);
    structure_.drive = loop ? Drive::velocity_loop : Drive::force_source;
    structure_.transmission = loop ? Transmission::backlash : Transmission::rigid;
    if (!loop && is_of_angles(first)) structure_.joint = Joint::revolute;
  }

  Vocabulary vocabulary() const { return vocabulary_of(structure_); }
  /// As the job calls it.
  const QuantityEntry& quantity(std::string_view name) const {
    return quantity_list(vocabulary())[find_quantity(name)->index];
  }
  std::string say(std::string_view text) const { return std::string(words_on(vocabulary(), text)); }

  std::string_view command_unit() const { return unit_on(vocabulary(), kCommandUnit); }

  bool force_source() const { return capabilities(structure_).is_force_driven; }
  bool is_direct() const { return capabilities(structure_).is_direct(); }

  bool has_measured(const Source& source) const {
    return std::ranges::any_of(source.guess.columns, [&](const GuessedColumn& c) {
      return is_measured(c) && &c != &input_of(source);
    });
  }

  /// One input for all recordings of a force source, since K_f belongs to it: one that all have, at
  /// best one that changes in all, or else the first of them.
  void choose_inputs() {
    if (!force_source()) {
      for (Source& source : sources_) {
        source.input = capabilities(structure_).has_back_emf
                           ? voltage_input(source.guess)
                           : velocity_input(source.guess, !axis_.empty());
        if (!source.input || source.input->kind != Kind::velocity) continue;
        GuessedColumn& column = *source.guess.find(Kind::velocity, true);
        column.reasons.push_back(fmt::format("a set velocity, taken as a command of {:g} V per m/s",
                                             source.input->gain));
        column.guessed = true;
      }
      return;
    }
    const auto of_all = [&](auto&& has) {
      return std::ranges::find_if(kForceInputs, [&](const Input& input) {
        return std::ranges::all_of(sources_, [&](const Source& s) { return has(s.guess, input); });
      });
    };
    auto chosen = of_all(has_changing_input);
    if (chosen == kForceInputs.end()) chosen = of_all(has_input);
    if (chosen == kForceInputs.end())
      chosen = std::ranges::find_if(kForceInputs, [&](const Input& input) {
        return has_input(sources_.front().guess, input);
      });
    for (Source& source : sources_)
      if (chosen != kForceInputs.end() && has_input(source.guess, *chosen)) {
        source.input = *chosen;
        // A part of a rating is a force only once K_f says how large.
        if (input_of(source).of_rating) source.input->key = "command";
      }
    if (axis_.empty() && chosen != kForceInputs.end() && sources_.front().input) {
      if (input_of(sources_.front()).of_rating)
        structure_.drive = Drive::rated_force;
      else if (chosen->kind == Kind::current)
        structure_.drive = Drive::motor_current;
    }
    for (Source& source : sources_) write_rating(source);
  }

  /// The job takes a part of a rating as it is, where the drive does.
  void write_rating(Source& source) const {
    if (!source.input || !input_of(source).of_rating || command_unit() != "1") return;
    GuessedColumn& input = *source.guess.find(source.input->kind, source.input->is_setpoint);
    constexpr double kPercent = 0.01;
    input.unit = "%";
    for (double& x : input.values) x *= kPercent;
    std::erase_if(input.reasons, [](const std::string& r) { return r.starts_with(kInPercent); });
    input.guessed = false;
  }

  void drop_recordings_without_input() {
    std::vector<std::string> unusable;
    std::erase_if(sources_, [&](const Source& source) {
      const bool driven = source.input.has_value();
      if (driven && has_measured(source)) return false;
      unusable.push_back(sanitized(fmt::format(
          "{}: no column {}; the columns are {}. If one of them does, say so by --column {}; "
          "otherwise record that signal.",
          source.guess.path, driven ? "shows how the axis moved" : "shows what drove the axis",
          fmt::join(names_of(source), ", "),
          driven           ? "position=COLUMN:mm or velocity=COLUMN:m/s"
          : force_source() ? "current=COLUMN:A, force=COLUMN:N or command=COLUMN:V"
                           : "command=COLUMN:V")));
      return true;
    });
    if (sources_.empty()) throw std::runtime_error(fmt::format("{}", fmt::join(unusable, "\n")));
    for (const std::string& text : unusable) guesses_.push_back("Skipped: " + text);
  }

  static std::vector<double> driving(const Source& source) {
    std::vector<double> values = input_of(source).values;
    for (double& x : values) x *= source.input->gain;
    return values;
  }

  /// With gravity where that leaves clearly less of the force unbalanced.
  std::optional<ForceBalance> balance_of(const Source& source) const {
    constexpr double kLeft = 0.6;
    const auto left = [](const ForceBalance& b) { return 1.0 - b.correlation * b.correlation; };
    auto plain = balance_of(source, false);
    if (vocabulary().joint != Joint::revolute) return plain;
    const auto with = balance_of(source, true);
    return with && (!plain || left(*with) < kLeft * left(*plain)) ? with : plain;
  }

  static std::optional<ForceBalance> balance_of(const Source& source, bool with_gravity) {
    const GuessedColumn *position = source.guess.find(Kind::position),
                        *velocity = source.guess.find(Kind::velocity);
    const std::vector<double> none;
    return force_balance(source.guess.time.values, position ? position->values : none,
                         velocity ? velocity->values : none, driving(source), with_gravity);
  }

  /// The axis file that is missing.
  void start_axis() {
    const Source& first = sources_.front();
    if (gain_ && (!force_source() || drives_in_newtons(first)))
      throw std::runtime_error(fmt::format(
          "--gain is the {} per unit of a current or command, but {} is {}: leave it out",
          say("force"), sanitized(input_of(first).column),
          force_source() ? say("a force") : "a velocity that is asked for"));
    if (!force_source()) {
      starter_ = velocity_loop_starter(first.file);
      axis_text_ = starter_->text;
      guesses_.push_back("axis.yaml describes a velocity loop with the values of a published axis");
      return;
    }
    const GuessedColumn* velocity = first.guess.find(Kind::velocity);
    DrivenMass seen;
    seen.column = input_of(first).column;
    seen.is_force = drives_in_newtons(first);
    seen.largest_input = largest(driving(first));
    if (velocity) seen.largest_speed = largest(velocity->values);
    seen.balance = balance_of(first);
    seen.gain = gain_;
    seen.structure = structure_;
    seen.has_gravity = seen.balance && seen.balance->gravity_sine != 0.0;
    starter_ = mass_starter(first.file, seen);
    structure_ = starter_->structure;
    axis_text_ = starter_->text;
    if (starter_->gain_guessed)
      guesses_.push_back(
          fmt::format("the drive gain, K_f in axis.yaml: {}, B_a and the friction {} scale with it",
                      quantity("M").name, say("forces")));
  }

  static bool drives_in_newtons(const Source& source) {
    return source.input->key == std::string_view("drive_force");
  }

  static double largest(const std::vector<double>& values) {
    double size = 0.0;
    for (const double x : values) size = std::max(size, std::abs(x));
    return size;
  }

  /// How the input of a recording goes with the motion: near one where it drives it, near minus one
  /// where it is recorded with the other sign.
  std::optional<double> agreement(const Source& source) const {
    if (force_source()) {
      const auto balance = balance_of(source);
      return balance ? std::optional(balance->correlation) : std::nullopt;
    }
    const GuessedColumn* position = source.guess.find(Kind::position);
    if (position == nullptr || source.input->key != std::string_view("command")) return {};
    const auto found = rate_ratio(source.guess.time.values, position->values, driving(source));
    return found ? std::optional(found->correlation) : std::nullopt;
  }

  /// What the position tells better.
  void drop_idle_velocities() {
    for (Source& source : sources_) {
      const GuessedColumn& input = input_of(source);
      GuessedColumn* velocity = source.guess.find(Kind::velocity);
      if (velocity == nullptr || velocity == &input) continue;
      const double late = lateness(source.guess);
      // The simulation of a direct drive follows the recording.
      velocity->idle = late > 0.0 || (is_direct() && is_velocity_idle(source.guess, input.values));
      if (late > 0.0)
        velocity->reasons.push_back(fmt::format(
            "not used: it comes {:.2g} ms behind the derivative of the position, as one "
            "that a filter has smoothed",
            1e3 * late));
      else if (velocity->idle)
        velocity->reasons.push_back("not used: the position tells the same more precisely");
    }
  }

  /// A column has one sign in all recordings. It is turned if some clearly say so and none clearly
  /// the contrary; what is not clear is asked. A force that nobody recorded, such as that of
  /// gravity on a joint, can look like a wrong sign.
  void correct_signs() {
    constexpr double kClear = 0.8, kSome = 0.5;
    std::map<std::string, std::vector<std::pair<Source*, double>>> of_column;
    for (Source& source : sources_)
      of_column[input_of(source).column].emplace_back(&source, agreement(source).value_or(0.0));
    for (auto& column : of_column) {
      auto& found = column.second;
      const auto any = [&](auto&& holds) {
        return std::ranges::any_of(found, [&](const auto& f) { return holds(f.second); });
      };
      if (!any([&](double c) { return c < -kSome; })) continue;
      const bool turned =
          any([&](double c) { return c < -kClear; }) && !any([&](double c) { return c > kClear; });
      std::vector<std::string> each;
      for (const auto& [source, correlation] : found)
        each.push_back(sources_.size() > 1 ? fmt::format("{:.2f} in {}", correlation, source->name)
                                           : fmt::format("{:.2f}", correlation));
      const std::string reason =
          fmt::format("the axis {} in the opposite direction (correlation {}): {}",
                      force_source() ? "accelerates" : "moves", fmt::join(each, ", "),
                      turned ? "its sign was inverted" : "is its sign right? It was left as it is");
      for (auto& [source, correlation] : found) {
        GuessedColumn& input = *source->guess.find(source->input->kind, source->input->is_setpoint);
        if (turned) {
          input.negative = !input.negative;
          for (double& x : input.values) x = -x;
        }
        input.reasons.push_back(reason);
        input.guessed = true;
      }
    }
  }

  // What is free

  void list_candidates() {
    // What no data sheet tells, the most wanted first. A gain of the drive last: what it scales
    // has precedence.
    static const std::vector<std::string> kCandidates{"M",   "B_a", "V_L", "T_p",
                                                      "k_g", "b_g", "F_s", "H"};
    const auto add = [&](const std::string& name, const std::string& entry = "{}") {
      const QuantityEntry& called = quantity(name);
      if (is_used(called, structure_)) candidates_.push_back({called.name, entry});
    };
    if (capabilities(structure_).has_back_emf)
      for (const char* of_motor : {"K_m", "R"}) add(of_motor);
    // Wherever the user's K_f takes them.
    const bool any_gain = starter_ && starter_->gain_guessed;
    const auto bounds = [](double lower, double upper, std::string_view unit) {
      return fmt::format("{{bounds: [{}, {}]}}", with_unit(lower, unit), with_unit(upper, unit));
    };
    for (const std::string& name : kCandidates) {
      if (name == "F_s" && force_source()) continue;
      const Quantity& q = quantity(name).quantity;
      const double least = vocabulary().joint == Joint::prismatic ? 1e-3 : 1e-6;
      add(name, any_gain ? bounds(std::max(q.lower, least), q.upper, q.unit) : "{}");
    }
    for (const QuantityEntry& entry : quantity_list()) {
      if (!entry.effect || !is_used(entry, structure_) || entry.quantity.shape) continue;
      const Quantity& q = quantity(entry.name).quantity;
      const bool force = starter_ && entry.quantity.unit == "N";
      const double most =
          force ? std::min((any_gain ? 1e4 : 2.0) * starter_->largest_force, q.upper) : 0.0;
      add(entry.name, force ? bounds(q.lower < 0.0 ? -most : 0.0, most, q.unit) : "{}");
    }
    if (starter_ && !force_source()) add("K_1");
    if (joined_) add_delay();
    // An encoder that rounds down reads half a step low.
    const RecordingGuess& first = sources_.front().guess;
    const GuessedColumn* position = first.find(Kind::position);
    const bool offset = position && !is_direct() && !is_rounded_away(*position, first);
    if (const double resolution = offset ? resolution_of(position->values) : 0.0; resolution > 0.0)
      add("position.bias", bounds(-round_to_digits(resolution, 2), round_to_digits(resolution, 2),
                                  unit_on(vocabulary(), "m")));
    if (!force_source() || std::ranges::any_of(sources_, drives_in_newtons)) return;
    add("K_f");
    if (starter_ || is_machine_) candidates_.back().reason_not_free = kOnlyRatios;
  }

  /// A drive that holds its current for a sample is not what a straight line between samples says.
  /// The motion is often logged a sample or two after what drives it, or before, which a fit
  /// without a delay takes for a smaller force. Each as short fits show it.
  void try_timing() {
    const std::vector<double>& times = sources_.front().guess.time.values;
    if (!force_source() || joined_ || times.size() > kMostSamplesToTry) return;
    const auto fitted = [&] {
      Job job = read_job();
      job.options.starts = 1;
      return estimate(job);
    };
    constexpr double kLeastFall = 2.0, kLeastSamples = 0.5;
    FitResult without = fitted();
    const auto swap_holds = [&] {
      for (Source& source : sources_) source.has_other_hold = !source.has_other_hold;
    };
    swap_holds();
    FitResult swapped = fitted();
    if (swapped.status == Status::converged &&
        kLeastFall * swapped.reduced_chi_square < without.reduced_chi_square)
      without = std::move(swapped);
    else
      swap_holds();
    add_delay();
    const FitResult with = fitted();
    const double delay = with.parameters.back().value;
    if (with.status == Status::converged &&
        std::abs(delay) > kLeastSamples * sampling(times).interval &&
        kLeastFall * with.reduced_chi_square < without.reduced_chi_square) {
      guesses_.push_back(
          fmt::format("T_d is free: the motion {} what drives it by {:.2g} ms, with which the "
                      "chi-square falls from {:.3g} to {:.3g}; it is the time lag of drive or log",
                      delay > 0.0 ? "follows" : "is logged before", 1e3 * std::abs(delay),
                      without.reduced_chi_square, with.reduced_chi_square));
    } else {
      candidates_.pop_back();
    }
  }

  /// Whether what drives the axis was measured, not commanded.
  static bool is_measured_input(const Source& source) {
    const GuessedColumn& input = input_of(source);
    return !input.is_setpoint && (input.kind == Kind::current || input.kind == Kind::force ||
                                  input.kind == Kind::motor_voltage);
  }

  /// Two clocks may differ to either side.
  void add_delay() {
    const double interval = sampling(sources_.front().guess.time.values).interval;
    const double initial = joined_ ? 0.0 : round_to_digits(interval, 2);
    const double most = joined_ ? kRoom : round_to_digits(20.0 * interval, 2);
    candidates_.push_back(
        {"T_d", fmt::format("{{initial: {}, bounds: [-{}, {}]}}", with_unit(initial, "s"),
                            with_unit(most, "s"), with_unit(most, "s"))});
  }

  /// Whether the noise of a position is below the steps of its encoder, while a velocity tells of
  /// the same motion. Steps are no noise: at rest they are an offset. A direct drive needs the
  /// position all the same, for what the velocity says little of: slow friction.
  bool is_rounded_away(const GuessedColumn& position, const RecordingGuess& recording) const {
    return !is_direct() && recording.find(Kind::velocity) &&
           noise_from_differences(position.values) < resolution_of(position.values);
  }

  /// Takes out one after the other what the recordings leave open, the least wanted first. What is
  /// told apart only by effects that the machine need not have is open, too.
  void choose_free() {
    constexpr double kHardly = 1e-3;
    if (take_out_open(1.0)) take_out_open(kHardly);
  }
  /// With the effects at that part of their initial strengths. False: it cannot be told.
  bool take_out_open(double strength) {
    for (;;) {
      const Job job = read_job();
      const std::vector<double> start = draw_start(job, 0);
      std::vector<double> values = start;
      for (std::size_t i = 0; i < values.size(); ++i) {
        const QuantityEntry& entry = job.entry(job.free[i].quantity);
        if (entry.effect && entry.quantity.lower == 0.0) values[i] *= strength;
      }
      if (strength != 1.0 && values == start) return true;  // looked at already
      const Forecast found = forecast(job, values);
      if (!found.finite) {
        guesses_.push_back(
            "identifiability could not be checked: with the values of the axis file the simulation "
            "does not finish");
        return false;
      }
      if (job.free.size() == 1) return true;
      Candidate* last = nullptr;
      bool unseen = false;
      std::size_t index = 0;
      for (Candidate& candidate : candidates_) {
        if (!candidate.reason_not_free.empty()) continue;
        const ParameterUncertainty& u = found.uncertainty.parameters[index];
        if (!u.determined || u.weak) {
          last = &candidate;
          unseen = std::ranges::count(found.identifiability.without_influence, index) > 0;
        }
        ++index;
      }
      if (last == nullptr) return true;
      const std::string_view need =
          excitation_needed(*find_quantity(last->name, vocabulary()), vocabulary());
      last->reason_not_free =
          unseen ? "no recorded signal depends on it" : "these recordings do not determine it";
      if (!need.empty()) last->reason_not_free += fmt::format("; it needs {}", need);
      if (last->name == "K_f") last->reason_not_free = kOnlyRatios;
    }
  }

  /// The job as the reader takes it, which is also the proof that it does.
  Job read_job() const {
    try {
      return read_job_draft(files(), fs::absolute(folder_).string()).job;
    } catch (const ConfigError& error) {
      // The places are of a file that the user never sees.
      std::set<std::string> messages;
      for (const Diagnostic& d : error.diagnostics()) messages.insert(d.message);
      throw std::runtime_error(fmt::format("no job can be created from these recordings:\n{}",
                                           fmt::join(messages, "\n")));
    }
  }

  Files files() const {
    Files files;
    if (!axis_text_.empty()) files.emplace_back(kAxisName, modeline("axis") + axis_text_);
    files.emplace_back(kJobName, modeline("job") + job_text());
    return files;
  }

  // The job file

  std::string job_text() const {
    std::string text = fmt::format(
        "# Written by axisfit {} --init. It can be run as it is:\n#\n#   fit-params {} --check    "
        "what the recordings show, before the fit\n#   fit-params {}\n#\n# Values marked GUESSED "
        "do not follow from the recordings: check them first. All\n# keys: "
        "docs/job-file.md.\naxis: {}\nrecordings:\n",
        version(), kJobName, kJobName, scalar(axis_text_.empty() ? relative(axis_) : kAxisName));
    for (std::size_t i = 0; i < sources_.size(); ++i)
      text += recording_text(sources_[i], sources_.size() > 1 && i + 1 == sources_.size());
    text +=
        fmt::format("free:   # initial values are those of the axis file{}\n",
                    starter_ && starter_->gain_guessed ? "; bounds leave room for any K_f" : "");
    for (const Candidate& c : candidates_) {
      if (c.reason_not_free.empty())
        text += fmt::format("  {}: {}\n", c.name, c.entry);
      else
        text +=
            comment(fmt::format("{}: {}   not free: {}", c.name, c.entry, c.reason_not_free), 2);
    }
    return text + fit_text();
  }

  std::string recording_text(const Source& source, bool validates) const {
    const RecordingGuess& guess = source.guess;
    std::string text =
        fmt::format("  - name: {}\n    file: {}\n", scalar(source.name), scalar(source.file));
    text +=
        validates ? "    role: validate   # not fitted: validates the fit\n" : "    role: fit\n";
    text += initial_text(guess);
    const Sampling found = sampling(guess.time.values);
    text += reasons_text(guess.time, 4);
    text +=
        fmt::format("    time: {}   # {:.4g} Hz, {:.4g} s\n",
                    column_map(guess.time, guess.time.unit), 1.0 / found.interval, found.duration);
    text += "    signals:\n";
    const GuessedColumn& input = input_of(source);
    text += input_text(source, input);
    std::vector<std::string> unused = guess.unused;
    for (const GuessedColumn& c : guess.columns) {
      if (&c == &input) continue;
      if (c.idle) {
        text += reasons_text(c, 6) +
                fmt::format("      # {}: {}\n", name_of(c.kind), column_map(c, c.unit));
        continue;
      }
      if (!is_measured(c)) {
        unused.push_back(c.column);
        continue;
      }
      GuessedColumn written = c;
      const bool compared = c.kind == Kind::position && is_rounded_away(c, guess);
      if (compared)
        written.reasons.push_back(
            fmt::format("compared only: its resolution of {:.3g} {} is not noise, and the velocity "
                        "carries the same information",
                        resolution_of(c.values), unit_on(vocabulary(), "m")));
      text += reasons_text(written, 6);
      text +=
          fmt::format("      {}: {}\n", name_of(c.kind),
                      compared ? column_map(c, c.unit, {"fit", "false"}) : column_map(c, c.unit));
    }
    text += channels_text(guess.channels, unused);
    if (!unused.empty()) text += comment(fmt::format("Not used: {}", fmt::join(unused, ", ")), 4);
    return text;
  }

  /// Whether all recordings have channels of the same names: a job needs them in each.
  bool have_same_channels() const {
    const auto names = [](const Source& source) {
      std::vector<std::string> list;
      for (const GuessedChannel& c : source.guess.channels) list.push_back(c.guess.name);
      std::ranges::sort(list);
      return list;
    };
    return std::ranges::all_of(
        sources_, [&](const Source& s) { return names(s) == names(sources_.front()); });
  }

  /// What may act on the axis, for --close-loop to try; else it is not used.
  std::string channels_text(const std::vector<GuessedChannel>& channels,
                            std::vector<std::string>& unused) const {
    if (channels.empty()) return {};
    if (!have_same_channels()) {
      for (const GuessedChannel& c : channels) unused.push_back(c.column);
      return {};
    }
    std::string text = comment("These may act on the axis: --close-loop tries them as causes.", 4) +
                       "    channels:\n";
    for (const GuessedChannel& c : channels) {
      GuessedColumn column;
      column.column = c.column;
      text += fmt::format("      {}: {}\n", c.guess.name, column_map(column, c.guess.unit));
    }
    return text;
  }

  static std::string reasons_text(const GuessedColumn& column, std::size_t indent) {
    if (column.reasons.empty()) return {};
    return comment(
        fmt::format("{}{}.", column.guessed ? kGuessed : "", fmt::join(column.reasons, "; ")),
        indent);
  }

  std::string input_text(const Source& source, const GuessedColumn& input) const {
    GuessedColumn written = input;
    written.factor *= source.input->gain;
    std::string unit = input.unit;
    const std::string_view taken = command_unit();
    if (source.input->key == std::string_view("command") &&
        !std::holds_alternative<double>(unit_factor(unit, taken))) {
      // The job's command is in the unit of the drive, whatever was recorded.
      const auto factor = unit_factor(unit, unit_on(vocabulary(), si_unit(input.kind)));
      written.factor *= std::get<double>(factor);
      unit = taken;
      if (source.input->kind != Kind::velocity)
        written.reasons.push_back(fmt::format(
            "the command of the axis; the job treats it as {}, whatever its unit, and K_f as {}",
            taken, quantity("K_f").quantity.unit));
    }
    std::pair<std::string, std::string> hold;
    const bool in_newtons = drives_in_newtons(source),
               is_linear = is_measured_input(source) != source.has_other_hold;
    if (is_linear != in_newtons)  // else the default of the key
      hold = {"hold", is_linear ? "linear" : "zero_order"};
    if (!hold.first.empty() || source.has_other_hold)
      written.reasons.push_back(std::string(is_linear
                                                ? "it goes straight from one sample to the next"
                                                : "each value holds until the next") +
                                (source.has_other_hold ? ": so the motion goes better with it"
                                 : is_linear           ? ", as what is measured does"
                                                       : ", as what is commanded does"));
    return reasons_text(written, 6) +
           fmt::format("      {}: {}\n", say(source.input->key),
                       column_map(written, unit, hold, source.input_file, source.input_offset));
  }

  /// A recording that begins at rest needs no more than where; another one its first samples.
  std::string initial_text(const RecordingGuess& guess) const {
    const GuessedColumn *position = guess.find(Kind::position),
                        *velocity = guess.find(Kind::velocity);
    if (position == nullptr && velocity == nullptr) return {};
    if (is_direct()) return "    initial_state: data   # from the first samples\n";
    constexpr std::size_t kFirst = 4;
    double speed = 0.0, noise = 0.0;
    if (velocity) {
      for (std::size_t i = 0; i < kFirst; ++i) speed += velocity->values[i] / double(kFirst);
      noise = noise_from_differences(velocity->values);
    } else {
      const auto& t = guess.time.values;
      speed = (position->values[kFirst] - position->values[0]) / (t[kFirst] - t[0]);
      noise = std::max(noise_from_differences(position->values), resolution_of(position->values)) /
              (t[kFirst] - t[0]);
    }
    if (std::abs(speed) > 5.0 * noise + 1e-9)
      return "    initial_state: data   # from the first samples: the axis is already moving\n";
    if (position == nullptr || position->values.front() == 0.0) return {};
    return fmt::format("    set: {{initial.y0: {}}}   # it starts at rest at this position\n",
                       with_unit(position->values.front(), unit_on(vocabulary(), "m")));
  }

  /// By how much the velocity comes behind the derivative of the position, s, where it clearly does
  /// by two samples or more; or else zero.
  static double lateness(const RecordingGuess& recording) {
    const GuessedColumn *position = recording.find(Kind::position),
                        *velocity = recording.find(Kind::velocity);
    constexpr std::size_t kMost = 20;
    const std::size_t n = recording.time.values.size();
    if (position == nullptr || velocity == nullptr || n < 10 * kMost) return 0.0;
    /// The part of the velocity that is not that derivative, so many samples before.
    const auto unlike = [&](std::size_t samples) {
      const auto found = rate_ratio(std::span(recording.time.values).first(n - samples),
                                    std::span(position->values).first(n - samples),
                                    std::span(velocity->values).last(n - samples));
      return found ? 1.0 - found->correlation * std::abs(found->correlation) : 1.0;
    };
    std::size_t best = 0;
    double least = unlike(0);
    const double now = least;
    for (std::size_t samples = 1; samples <= kMost; ++samples)
      if (const double left = unlike(samples); left < least) {
        least = left;
        best = samples;
      }
    constexpr double kClear = 0.5;
    return best >= 2 && least < kClear * now
               ? static_cast<double>(best) * sampling(recording.time.values).interval
               : 0.0;
  }

  /// Whether the velocity says less than the position, over the time in which an observer follows
  /// them: then the simulation would follow its noise. Drives often compute it from the position.
  static bool is_velocity_idle(const RecordingGuess& recording, const std::vector<double>& input) {
    const GuessedColumn *position = recording.find(Kind::position),
                        *velocity = recording.find(Kind::velocity);
    if (position == nullptr || velocity == nullptr) return false;
    const double rate = suggested_observer_gain(recording.time.values, position->values, {}, input);
    // The slope of a line through the positions of that time, beside the mean of the velocities.
    constexpr double kSlope = 3.46, kClear = 2.0;
    const double noise = std::max(noise_from_differences(position->values),
                                  resolution_of(position->values) / kSlope);
    return noise_from_differences(velocity->values) > kClear * kSlope * noise * rate;
  }

  std::string_view name_of(Kind kind) const { return info(*signal_of(kind), vocabulary()).name; }

  std::string fit_text() const {
    // A mass that a force drives is an open integral: free running it drifts away from the
    // recording whatever the fit.
    const RecordingGuess& first = sources_.front().guess;
    const GuessedColumn *position = first.find(Kind::position),
                        *velocity = first.find(Kind::velocity);
    const bool is_open =
        is_direct() && sources_.front().input->key != std::string_view("position_reference");
    if (!is_direct() && capabilities(structure_).has_backlash)
      return "fit:\n" +
             comment(
                 "The ringing of the gear and the limits of the drive make wrong minima and narrow "
                 "valleys: of several starts the best counts.",
                 2) +
             "  starts: 8\n  max_iterations: 150\n";
    if (sources_.front().input->kind == Kind::position)
      return "fit:\n  max_iterations: 150   # what a sampled controller rounds makes the valley "
             "rough\n";
    if (!is_open || position == nullptr) return {};
    const std::vector<double> none;
    const double rate = suggested_observer_gain(
        first.time.values, position->values, velocity && !velocity->idle ? velocity->values : none,
        input_of(sources_.front()).values);
    return "fit:\n" +
           comment(
               "The position is an open-loop integral of the " + say("force") +
                   ": a free-running simulation "
                   "drifts away however good the fit. An observer therefore makes the simulation "
                   "track "
                   "the recording, and the fit minimises the prediction error. At this gain, an "
                   "unmodelled hundredth of the acceleration would show as ten times the noise; a "
                   "higher gain hides more. What is missing bends the estimates, by more at one "
                   "gain "
                   "than "
                   "at another: if half the gain changes them by more than their standard errors, "
                   "those are too small.",
               2) +
           fmt::format("  observer: {{fixed: {} 1/s}}\n", round_to_digits(rate, 2));
  }

  std::string axis_;  ///< file, or name of a machine
  bool is_machine_ = false;
  std::string folder_;
  std::string axis_text_;       ///< of the axis file to write; empty: that of the user
  std::optional<double> gain_;  ///< N/V, of the user
  std::vector<ColumnAnswer> answers_;
  bool joined_ = false;  ///< of two files: their clocks may differ
  std::vector<Source> sources_;
  Structure structure_;
  std::optional<StarterAxis> starter_;  ///< none where an axis file is given
  std::vector<Candidate> candidates_;
  std::vector<std::string> guesses_;
};

}  // namespace

InitialJob initial_job(const std::vector<std::string>& recordings, const std::string& axis,
                       const std::string& folder, std::optional<double> gain,
                       const std::vector<ColumnAnswer>& answers, bool is_machine) {
  return Initialiser(axis, is_machine, folder, gain, answers).make(recordings);
}

std::vector<std::string> machines_for(const std::vector<std::string>& recordings,
                                      const std::vector<ColumnAnswer>& answers) {
  std::vector<std::string> names;
  const RecordingGuess first =
      guess_recording(RecordingFile(recordings.front()), recordings.front(), answers);
  if (first.time.values.size() > kMostSamplesToTry || is_of_velocity_loop(first)) return names;
  const auto input = std::ranges::find_if(
      kForceInputs, [&](const Input& i) { return has_changing_input(first, i); });
  const auto is_driven_by = [&](const Capabilities& has) {
    if (has.is_electric) return first.find(Kind::set_velocity) || first.find(Kind::velocity, true);
    if (has.has_back_emf) {
      // What a servo reports beside its goal is its duty, or some other measure of how hard it
      // pulls.
      const bool has_force = input != kForceInputs.end() && input->kind != Kind::command;
      return first.find(Kind::motor_voltage) != nullptr || (!has_force && voltage_input(first));
    }
    if (input == kForceInputs.end() || !has.is_force_driven) return false;
    if (first.find(input->kind, input->is_setpoint)->of_rating)
      return has.command == Command::share_of_rated;
    return input->kind == Kind::current && has.command == Command::current;
  };
  for (const MachineAxis& machine : machine_axes()) {
    Diagnostics diagnostics;
    const auto rig =
        read_axis(*ConfigNode::parse(std::string(machine.text), "", diagnostics), diagnostics);
    const Structure& structure = rig->model.structure;
    const bool moves_so = has_motion_without_unit(first) ||
                          (structure.joint == Joint::revolute) == is_of_angles(first);
    if (moves_so && is_driven_by(capabilities(structure))) names.emplace_back(machine.name);
  }
  return names;
}

}  // namespace axisfit
