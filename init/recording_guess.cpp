#include "init/recording_guess.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "fit/data/recording_check.h"
#include "init/columns/derivative_rule.h"
#include "init/columns/heading.h"
#include "init/columns/range_rule.h"
#include "init/columns/resample.h"
#include "init/columns/roles.h"
#include "init/columns/time_column.h"
#include "init/columns/unnamed.h"

namespace axisfit {
namespace {

using Values = std::vector<double>;

/// What may be of one value throughout, as that of a step or of a free run.
bool may_be_constant(Kind kind) {
  return kind == Kind::command || kind == Kind::set_velocity || kind == Kind::current ||
         kind == Kind::motor_voltage || kind == Kind::force || kind == Kind::supply;
}

bool is_place(Kind kind) { return kind == Kind::position || kind == Kind::load_position; }

class Guesser {
 public:
  Guesser(const RecordingFile& file, const std::string& path, const GuessOptions& options)
      : file_(file), path_(path), options_(options) {}

  RecordingGuess guess() {
    headings_ = headings_of(file_, path_, options_.answers.columns);
    time_ = find_time(file_, path_, headings_, options_.answers.rate);
    if (time_.place) name_unit(time_.column, headings_[*time_.place]);
    find_columns();
    if (std::ranges::all_of(file_.columns(), [](const Column& c) { return c.name.empty(); }))
      take_unnamed();
    size_columns();
    find_supply();
    RecordingGuess result{path_, finished(time_.column), {}, {}, {}};
    result.channels = find_channels();
    result.rate = time_.rate;
    result.motor = motor_;
    result.notes = std::move(notes_);
    for (auto& [key, column] : columns_) result.columns.push_back(finished(column));
    for (GuessedColumn& column : result.columns) multiply_by_supply(column);
    result.unused = std::move(unused_);
    result.constant = std::move(constant_);
    return result;
  }

 private:
  /// The values of a column at the times of the recording; none where they cannot be.
  Values at_times(std::size_t c) const {
    const Column& column = file_.columns()[c];
    Values values = column.values;
    headings_[c].overflow.undo(values);
    const auto clock = column.clock ? column.clock : time_.place;
    const Values times =
        time_.rate > 0.0 ? even_times(file_, time_.rate) : times_of_clock(file_, clock.value_or(0));
    if (times.size() != values.size() || !increases(without_gaps(times))) return {};
    return has_changes_only(c) ? held_at(time_.column.raw, times, values)
                               : interpolated_at(time_.column.raw, times, values);
  }

  /// Whether what drives the axis has a clock of its own that is far slower: whoever writes only
  /// what changes leaves out what stays.
  bool has_changes_only(std::size_t c) const {
    const auto clock = file_.columns()[c].clock;
    const auto& guess = headings_[c].guess;
    if (!clock || clock == time_.place || time_.column.raw.empty() || !guess ||
        !may_be_constant(guess->kind))
      return false;
    constexpr double kSlower = 3.0;
    const Sampling own = sampling(without_gaps(times_of_clock(file_, *clock)));
    return std::max(own.largest_gap, own.interval) > kSlower * sampling(time_.column.raw).interval;
  }

  bool is_clock(std::size_t c) const {
    return std::ranges::any_of(file_.columns(),
                               [c](const Column& column) { return column.clock == c; });
  }

  /// What name or answer say of unit and factor.
  static void name_unit(UnscaledColumn& column, const Heading& heading) {
    column.rank = heading.guess ? heading.guess->rank : 0;
    column.turns = heading.guess && heading.guess->turns;
    column.column.is_duty = heading.guess && heading.guess->is_duty;
    if (heading.answer != nullptr) {
      column.column.answer = heading.answer->column;
      column.answered = !heading.answer->unit.empty();
    }
    const Kind kind = column.column.kind;
    if (!heading.guess ||
        (heading.guess->kind != kind && !(is_place(heading.guess->kind) && is_place(kind))))
      return;
    column.named = column.answered ? heading.answer->unit : heading.guess->unit;
    const auto unit = stored_unit(kind, column.named);
    if (!unit) return;
    column.set_unit(*unit);
    if (!column.answered) return;
    const double factor = heading.answer->factor;
    column.column.factor *= factor;
    column.size *= std::abs(factor);
    if (factor < 0.0)
      for (double& x : column.raw) x = -x;
  }

  /// Columns that their names, or the user, say are signals.
  std::vector<Candidate> candidates() {
    std::vector<Candidate> list;
    for (std::size_t c = 0; c < headings_.size(); ++c) {
      const Heading& heading = headings_[c];
      if (c == time_.place) continue;
      Values values;
      if (heading.guess && heading.guess->kind != Kind::time && heading.is_usable)
        values = at_times(c);
      if (!values.empty())
        list.push_back(
            {c, heading.shown, *heading.guess, std::move(values), heading.answer != nullptr});
      else if (!is_clock(c))
        unused_.push_back(heading.shown);
    }
    return list;
  }

  void find_columns() {
    std::vector<Candidate> list = candidates();
    std::vector<std::string> others;
    try {
      motor_ = keep_one_axis(list, options_.answers.motor, others);
    } catch (const std::runtime_error& error) {
      throw RecordingError(path_, 0, error.what());
    }
    if (!motor_.empty() && options_.answers.motor.empty())
      notes_.push_back(
          fmt::format("the columns are of several axes, of which only {} moves: it was "
                      "taken; --motor names another one",
                      motor_));
    unused_.insert(unused_.end(), others.begin(), others.end());
    tell_references(list);
    tell_sides(list);
    rank_raw_last(list);
    for (Candidate& candidate : list) take(candidate);
  }

  /// Gives the column its role, unless another one has it that suits it better.
  void take(Candidate& candidate) {
    const Heading& heading = headings_[candidate.place];
    const Kind kind = candidate.name.kind;
    // A command is wanted by its nature.
    const bool command = kind == Kind::command || kind == Kind::set_velocity;
    const ColumnSet::Key key{kind, candidate.name.is_setpoint && !command};
    const UnscaledColumn* there = columns_.find(key.first, key.second);
    if (never_changes(candidate.values) && !candidate.is_answered &&
        (!may_be_constant(kind) || there != nullptr)) {
      unused_.push_back(heading.shown);
      constant_.push_back(heading.shown);
      return;
    }
    const bool supplies = is_supply(kind, candidate.values);
    if (supplies && !candidate.is_answered && channel_in(candidate.place)) {
      unused_.push_back(heading.shown);
      return;
    }
    constexpr int kSupply = 100;  // by which a supply ranks lower
    const int rank = candidate.name.rank - (supplies && !candidate.is_answered ? kSupply : 0);
    if (there != nullptr && there->rank >= rank && !never_changes(there->raw)) {
      unused_.push_back(heading.shown);
      return;
    }
    if (there != nullptr) unused_.push_back(there->shown);
    UnscaledColumn& column = add_column(candidate.place, key, std::move(candidate.values));
    name_unit(column, heading);
    column.rank = rank;
    if (heading.guess->is_setpoint != candidate.name.is_setpoint)
      column.guess("taken for a reference: it leads what was measured, and has no noise");
    if (!candidate.name.unknown_unit.empty() && column.size == 0.0)
      column.guess(fmt::format("'{}' is no unit of a {} that is known", candidate.name.unknown_unit,
                               is_place(kind) ? "position" : "signal of this kind"));
  }

  UnscaledColumn& add_column(std::size_t c, const ColumnSet::Key& key, Values values) {
    UnscaledColumn& column = columns_[key] = {};
    column.column.column = headings_[c].reference;
    column.shown = headings_[c].shown;
    column.column.kind = key.first;
    column.column.is_setpoint = key.second;
    column.raw = std::move(values);
    column.column.range = largest(column.raw);
    column.column.overflow = headings_[c].overflow;
    if (const Overflow& of = column.column.overflow; of.signed_bits > 0)
      column.guess(fmt::format("its values at the top of {} bits are taken as those below zero",
                               of.signed_bits));
    else if (of.wraps_after > 0.0)
      column.guess(fmt::format("it leaps by about {:.6g}, taken as a turn: made continuous",
                               of.wraps_after));
    const auto& clock = file_.columns()[c].clock;
    // Columns that go by equal times share them.
    if (clock && clock != time_.place &&
        (!time_.place || file_.columns()[*clock].values != file_.columns()[*time_.place].values)) {
      column.column.clock = headings_[*clock].reference;
      column.column.clock_unit = file_.columns()[*clock].unit;
      column.column.changes_only = has_changes_only(c);
    }
    return column;
  }

  void take_unnamed() {
    std::map<std::size_t, Values> free;
    for (std::size_t c = 0; c < headings_.size(); ++c) {
      if (c == time_.place || !headings_[c].is_usable || headings_[c].answer) continue;
      if (Values values = at_times(c); !values.empty() && !never_changes(values))
        free.emplace(c, std::move(values));
    }
    for (Inferred& found : infer_unnamed(time_.column.raw, columns_, free)) {
      UnscaledColumn& column = add_column(found.place, {found.kind, false}, free.at(found.place));
      column.guess(std::move(found.reason));
      std::erase(unused_, column.shown);
    }
  }

  /// Names have told what they know. Derivatives come next, and the range last.
  void size_columns() {
    UnscaledColumn& time = time_.column;
    if (!(time.size > 0.0) && !size_time_by_motion(time, columns_)) size_time_by_interval(time);
    UnscaledColumn *position = columns_.find(Kind::position),
                   *velocity = columns_.find(Kind::velocity);
    const bool is_told = velocity && velocity->size > 0.0;
    if (position && position->size == 0.0 && !is_told) size_by_range(*position);
    size_motion_by_derivative(time, columns_);
    for (UnscaledColumn* motion : {position, velocity})
      if (motion && motion->size == 0.0) size_by_range(*motion);
    size_acceleration_by_derivative(time, columns_);
    for (auto& [key, column] : columns_)
      if (column.size == 0.0) size_other(column);
  }

  /// That of the axis; where nobody knows it, that of a name such as "tau" or "theta", unless the
  /// motion was recorded in lengths.
  Joint joint() {
    const bool turns = std::ranges::any_of(columns_, [&](const auto& entry) {
      return entry.second.turns && entry.second.size == 0.0;
    });
    for (const Kind kind : {Kind::position, Kind::velocity})
      if (const UnscaledColumn* motion = columns_.find(kind);
          motion != nullptr && motion->joint == Joint::prismatic)
        return options_.joint;
    return turns ? Joint::revolute : options_.joint;
  }

  void size_by_range(UnscaledColumn& column) {
    const auto elsewhere = options_.ranges.find(column.column.column);
    const double other = elsewhere == options_.ranges.end() ? 0.0 : elsewhere->second;
    size_motion_by_range(column, joint(), std::max(column.column.range, other));
  }

  void size_other(UnscaledColumn& column) {
    const Kind kind = column.column.kind;
    const UnscaledColumn* measured = column.column.is_setpoint ? columns_.find(kind) : nullptr;
    if (kind == Kind::load_position) measured = columns_.find(Kind::position);
    if (measured != nullptr && measured->size > 0.0) {
      column.column.stored = measured->column.stored;
      column.column.unit = measured->column.unit;
      column.column.factor = measured->column.factor;
      column.size = measured->size;
      column.joint = measured->joint;
      column.guess(fmt::format("no unit in the header; same unit as {}", measured->column.column));
    } else if (is_place(kind) || kind == Kind::velocity) {
      size_by_range(column);
    } else if (kind == Kind::acceleration) {
      column.set_unit(*stored_unit(kind, "m/s^2"));
      column.guess("no unit in the header, and no velocity to infer it from");
    } else if (column.column.is_duty) {
      size_duty_by_range(column);
    } else {
      column.set_unit(*stored_unit(kind, si_unit(kind, joint())));
      column.guess(fmt::format("no unit in the header, taken as {}", column.column.unit));
    }
  }

  std::optional<ChannelGuess> channel_in(std::size_t c) const {
    return guess_channel(heading_text(file_.columns()[c]));
  }

  /// The voltage that a duty is a part of: what the user says, or a column that is called so.
  void find_supply() {
    UnscaledColumn* command = columns_.find(Kind::command);
    UnscaledColumn* answered = columns_.find(Kind::supply);
    if (command == nullptr || !command->column.is_duty) return;
    if (answered != nullptr) {
      use_supply(*command, answered->raw, *stored_unit(Kind::supply, answered->column.stored));
      command->column.supply = answered->column.column;
      return;
    }
    for (std::size_t c = 0; c < headings_.size(); ++c) {
      const auto unused = std::ranges::find(unused_, headings_[c].shown);
      if (unused == unused_.end() || !headings_[c].is_usable) continue;
      const Values values = at_times(c);
      const std::string unit = unit_of_supply(c, values);
      if (unit.empty() || values.empty()) continue;
      use_supply(*command, values, *stored_unit(Kind::supply, unit));
      command->column.supply = headings_[c].reference;
      command->reason(fmt::format("a duty of {}", headings_[c].shown));
      unused_.erase(unused);
      return;
    }
    // One that was taken for the motor's.
    const UnscaledColumn* motor = columns_.find(Kind::motor_voltage);
    if (motor == nullptr || motor->column.stored.empty() || motor->answered ||
        !is_supply(Kind::motor_voltage, motor->raw))
      return;
    use_supply(*command, motor->raw, *stored_unit(Kind::supply, motor->column.stored));
    command->column.supply = motor->column.column;
    command->reason(fmt::format("a duty of {}, which hardly changes", motor->shown));
    columns_.erase({Kind::motor_voltage, false});
  }

  /// Empty where the column is no supply: called so, or a voltage that hardly changes.
  std::string unit_of_supply(std::size_t c, const Values& values) const {
    const auto channel = channel_in(c);
    if (channel) return channel->name == "supply" ? channel->unit : "";
    const auto& guess = headings_[c].guess;
    const bool is_voltage = guess && !guess->unit.empty() && stored_unit(Kind::supply, guess->unit);
    return is_voltage && is_supply(guess->kind, values) ? guess->unit : "";
  }

  void use_supply(UnscaledColumn& command, const Values& values, const StoredUnit& unit) {
    command.column.supply_unit = unit.written;
    supply_ = values;
    for (double& x : supply_) x *= unit.size;
  }

  /// Of what is unused and changes. It is used then.
  std::vector<GuessedChannel> find_channels() {
    std::vector<GuessedChannel> channels;
    if (const UnscaledColumn* supply = columns_.find(Kind::supply); supply && supply_.empty())
      channels.push_back({supply->column.column, {"supply", supply->column.unit}});
    for (std::size_t c = 0; c < headings_.size() && channels.size() < kChannels; ++c) {
      const Column& column = file_.columns()[c];
      const auto unused = std::ranges::find(unused_, headings_[c].shown);
      if (unused == unused_.end() || !headings_[c].is_usable) continue;
      if (column.clock && column.clock != time_.place) continue;
      auto guess = channel_in(c);
      if (!guess || never_changes(without_gaps(column.values))) continue;
      const auto same = std::ranges::count_if(channels, [&](const GuessedChannel& other) {
        return other.guess.name.starts_with(guess->name);
      });
      if (same > 0) guess->name += fmt::format("_{}", same + 1);
      channels.push_back({headings_[c].reference, std::move(*guess)});
      unused_.erase(unused);
    }
    return channels;
  }

  static GuessedColumn finished(UnscaledColumn& column) {
    if (column.answered) column.column.guessed = false;
    GuessedColumn result = std::move(column.column);
    const bool is_rated = result.kind == Kind::current || result.kind == Kind::force;
    result.of_rating = is_rated && is_part_of_rating(result.stored);
    const double size = column.size * (result.negative ? -1.0 : 1.0);
    for (const double x : column.raw) result.values.push_back(x * size);
    return result;
  }

  /// The volts that a duty makes of its supply.
  void multiply_by_supply(GuessedColumn& column) const {
    if (column.supply.empty() || supply_.size() != column.values.size()) return;
    const double whole = is_part_of_rating(column.stored) ? 0.01 : 1.0;
    for (std::size_t i = 0; i < supply_.size(); ++i) column.values[i] *= whole * supply_[i];
  }

  const RecordingFile& file_;
  const std::string& path_;
  const GuessOptions& options_;
  std::vector<Heading> headings_;  ///< of the columns of the file
  TimeColumn time_;
  ColumnSet columns_;
  std::vector<std::string> unused_, constant_, notes_;
  std::string motor_;
  Values supply_;  ///< V
};

/// What there is to say of a unit that a job for that joint cannot write.
std::string remark_on(const GuessedColumn& column, const StoredUnit& unit, Joint joint) {
  const bool turns = joint == Joint::revolute;
  if (is_raw(unit.text))
    return fmt::format("counts of unknown size: set the factor to {} per count",
                       turns ? "radians" : "metres");
  if (column.of_rating)
    return fmt::format("{} {}, taken as {} here: multiply the factor by a hundredth of the rating",
                       kInPercent,
                       column.kind == Kind::force ? words_on(joint, "force") : "current",
                       si_unit(column.kind, joint));
  if (column.is_duty)
    return "a duty, and no column of its supply is known: its share of the whole is taken as V "
           "here";
  if (column.kind == Kind::command)
    return unit.written == unit.text ? std::string()
                                     : fmt::format("in {}, treated as V here", unit.text);
  if (!unit.joint || unit.joint == joint) return {};
  if (column.kind == Kind::force)
    return fmt::format("in {}: converted with a lever of 1 m; {} the factor by {}", unit.text,
                       turns ? "multiply" : "divide", turns ? "the lever" : "r_g");
  return turns ? fmt::format("in {}: 1 m is treated as 1 rad; divide the factor by the radius",
                             unit.text)
               : fmt::format("in {}: 1 rad is treated as 1 m; multiply the factor by the radius",
                             unit.text);
}

void write_unit(GuessedColumn& column, Joint joint) {
  const auto unit = stored_unit(column.kind, column.stored);
  if (!unit) {
    column.unit = si_unit(column.kind, joint);
    return;
  }
  const bool is_foreign = unit->joint && unit->joint != joint;
  if (!column.supply.empty()) {
    column.unit = unit->text;
    column.factor /= unit->factor;
    return;
  }
  if (unit->is_assumed || is_foreign || column.is_duty) {
    // The factor beside the unit that was stored, times its size.
    const double beside = column.factor / unit->factor;
    column.unit = si_unit(column.kind, joint);
    column.factor = beside * unit->size;
  }
  std::string remark = remark_on(column, *unit, joint);
  if (remark.empty()) return;
  column.reasons.push_back(std::move(remark));
  column.guessed = column.guessed || column.answer.empty() || is_raw(unit->text);
}

}  // namespace

const GuessedColumn* RecordingGuess::find(Kind kind, bool is_setpoint) const {
  for (const GuessedColumn& c : columns)
    if (c.kind == kind && c.is_setpoint == is_setpoint) return &c;
  return nullptr;
}

GuessedColumn* RecordingGuess::find(Kind kind, bool is_setpoint) {
  return const_cast<GuessedColumn*>(std::as_const(*this).find(kind, is_setpoint));
}

RecordingGuess guess_recording(const RecordingFile& file, const std::string& path,
                               const GuessOptions& options) {
  return Guesser(file, path, options).guess();
}

bool is_of_angles(const RecordingGuess& recording) {
  bool any = false;
  for (const Kind kind : {Kind::position, Kind::velocity}) {
    const GuessedColumn* column = recording.find(kind);
    const auto unit = column ? stored_unit(kind, column->stored) : std::nullopt;
    if (!unit || !unit->joint) continue;
    if (unit->joint != Joint::revolute) return false;
    any = true;
  }
  return any;
}

bool has_motion_without_unit(const RecordingGuess& recording) {
  const GuessedColumn* motion = recording.find(Kind::position);
  if (motion == nullptr) motion = recording.find(Kind::velocity);
  return motion != nullptr && motion->sized_by_range;
}

void write_units(RecordingGuess& recording, Vocabulary vocabulary) {
  for (GuessedColumn& column : recording.columns) write_unit(column, vocabulary.joint);
}

}  // namespace axisfit
