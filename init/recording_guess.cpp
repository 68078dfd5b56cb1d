#include "init/recording_guess.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <ranges>

#include "base/plain_text.h"
#include "base/rounding.h"
#include "fit/data/noise.h"
#include "fit/data/recording_check.h"
#include "io/recording/csv.h"

namespace axisfit {
namespace {

using Values = std::vector<double>;
constexpr std::size_t kMinSamples = 10;  // samples of a recording, as the reader of jobs wants

double largest(const Values& values) {
  double size = 0.0;
  for (const double x : values) size = std::max(size, std::abs(x));
  return size;
}

bool increases(const Values& values) {
  return std::ranges::adjacent_find(values, std::greater_equal<>()) == values.end();
}

bool never_changes(const Values& values) {
  return std::ranges::adjacent_find(values, std::not_equal_to<>()) == values.end();
}

/// What may be of one value throughout, as that of a step or of a free run.
bool may_be_constant(Kind kind) {
  return kind == Kind::command || kind == Kind::set_velocity || kind == Kind::current ||
         kind == Kind::motor_voltage || kind == Kind::force;
}

Values derivative(const Values& times, const Values& values) {
  Values rate(values.size(), 0.0);
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    rate[i] = (values[i + 1] - values[i - 1]) / (times[i + 1] - times[i - 1]);
  if (rate.size() > 2) {
    rate.front() = rate[1];
    rate.back() = rate[rate.size() - 2];
  }
  return rate;
}

/// A column while its unit is looked for.
struct UnscaledColumn {
  GuessedColumn column;
  std::string named;  ///< unit in its name; empty: none
  double size = 0.0;  ///< of the unit in SI; zero: not known yet
  const Values* raw = nullptr;
  int rank = 0;

  void set_unit(const StoredUnit& unit) {
    column.unit = unit.written;
    column.factor = unit.factor;
    size = unit.size;
  }
  void set_unit(double any_size) {
    column.unit = si_unit(column.kind);
    column.factor = any_size;
    size = any_size;
  }
  void reason(std::string text) { column.reasons.push_back(std::move(text)); }
  void guess(std::string text) {
    reason(std::move(text));
    column.guessed = true;
  }
};

class Guesser {
 public:
  explicit Guesser(const RecordingFile& file, const std::string& path) : file_(file), path_(path) {}

  RecordingGuess guess() {
    find_time();
    find_columns();
    size_time();
    size_motion();
    size_acceleration();
    for (auto& [key, column] : columns_)
      if (column.size == 0.0) size_other(column);
    explain(time_);
    RecordingGuess result{path_, finished(time_), {}, std::move(unused_), std::move(constant_)};
    for (auto& [key, column] : columns_) {
      explain(column);
      result.columns.push_back(finished(column));
    }
    return result;
  }

 private:
  using Key = std::pair<Kind, bool>;

  static bool usable(const Values& values) {
    return values.size() >= kMinSamples &&
           std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
  }

  /// What the header says of a column, with a row of units below the names as if they held them.
  std::optional<ColumnGuess> heading(const std::string& name) const {
    const std::string unit = file_.unit(name);
    return guess_column(unit.empty() ? name : fmt::format("{} [{}]", name, unit));
  }

  void find_time() {
    for (const auto& [name, values] : file_.columns()) {
      const auto guess = heading(name);
      if (!guess || guess->kind != Kind::time || !usable(values) || !is_sanitized(name)) continue;
      if (time_.raw == nullptr || guess->rank > time_.rank) set_time(name, values, *guess);
    }
    if (time_.raw != nullptr) return;
    // One that increases at an even pace, as nothing else does.
    for (const auto& [name, values] : file_.columns()) {
      if (!usable(values) || !is_sanitized(name) || !increases(values) ||
          sampling(values).jitter > 1e-3)
        continue;
      set_time(name, values, {});
      time_.guess("no column is named as the time; this one increases evenly");
      return;
    }
    std::vector<std::string> names;
    for (const auto& [name, values] : file_.columns()) names.push_back(name);
    throw RecordingError(path_, 0,
                         fmt::format("no column can be the sample time; the columns are {}: rename "
                                     "one of them to time_s, or add one",
                                     fmt::join(names, ", ")));
  }

  void set_time(const std::string& name, const Values& values, const ColumnGuess& guess) {
    time_ = {};
    time_.column.column = name;
    time_.column.kind = Kind::time;
    time_.named = guess.unit;
    time_.raw = &values;
    time_.rank = guess.rank;
  }

  void find_columns() {
    for (const auto& [name, values] : file_.columns()) {
      if (&values == time_.raw) continue;
      const auto guess = heading(name);
      if (!guess || guess->kind == Kind::time || !usable(values) || !is_sanitized(name) ||
          values.size() != time_.raw->size()) {
        unused_.push_back(name);
        continue;
      }
      // A command is wanted by its nature.
      const bool command = guess->kind == Kind::command || guess->kind == Kind::set_velocity;
      const Key key{guess->kind, guess->is_setpoint && !command};
      const auto there = columns_.find(key);
      const bool constant = never_changes(values);
      if (constant && (!may_be_constant(key.first) || there != columns_.end())) {
        unused_.push_back(name);
        constant_.push_back(name);
        continue;
      }
      if (there != columns_.end() && there->second.rank >= guess->rank &&
          !never_changes(*there->second.raw)) {
        unused_.push_back(name);
        continue;
      }
      if (there != columns_.end()) unused_.push_back(there->second.column.column);
      UnscaledColumn& column = columns_[key] = {};
      column.column.column = name;
      column.column.kind = key.first;
      column.column.is_setpoint = key.second;
      column.named = guess->unit;
      column.raw = &values;
      column.rank = guess->rank;
    }
    if (!time_.named.empty()) time_.set_unit(*stored_unit(Kind::time, time_.named));
    for (auto& [key, column] : columns_)
      if (!column.named.empty()) column.set_unit(*stored_unit(key.first, column.named));
  }

  UnscaledColumn* find(Kind kind, bool is_setpoint = false) {
    const auto at = columns_.find({kind, is_setpoint});
    return at == columns_.end() ? nullptr : &at->second;
  }

  /// By the interval between samples, unless a position and a velocity of known units tell.
  void size_time() {
    if (time_.size > 0.0) return;
    const UnscaledColumn *position = find(Kind::position), *velocity = find(Kind::velocity);
    if (position && velocity && position->size > 0.0 && velocity->size > 0.0) {
      const auto found = rate_ratio(*time_.raw, *position->raw, *velocity->raw);
      if (found && found->related()) {
        const StoredUnit* unit =
            unit_of_size(Kind::time, position->size / (std::abs(found->ratio) * velocity->size));
        if (unit != nullptr) {
          time_.set_unit(*unit);
          time_.reason(fmt::format("in {}, the derivative of the position agrees with the velocity",
                                   unit->text));
          return;
        }
      }
    }
    const double interval = sampling(*time_.raw).interval;
    const char* text = interval < 0.05   ? "s"
                       : interval < 50.0 ? "ms"
                       : interval <= 1e4 ? "us"
                                         : "ns";
    time_.set_unit(*stored_unit(Kind::time, text));
    time_.guess(
        fmt::format("no unit in the header; one sample every {:.4g}, taken as {}: {:.4g} Hz",
                    interval, text, 1.0 / (interval * time_.size)));
  }

  /// Position and velocity: each tells the unit of the other.
  void size_motion() {
    UnscaledColumn *position = find(Kind::position), *velocity = find(Kind::velocity);
    std::optional<RateRatio> found;
    if (position && velocity) {
      found = rate_ratio(*time_.raw, *position->raw, *velocity->raw);
      if (found && !found->related()) {
        velocity->guess(
            fmt::format("it does not follow the derivative of the position (correlation {:.2f}): "
                        "is it from the same axis?",
                        found->correlation));
        found.reset();
      }
    }
    if (position && position->size == 0.0) {
      if (found && velocity->size > 0.0) {
        from_ratio(*position, velocity->size * std::abs(found->ratio) * time_.size,
                   fmt::format("{} is {:.5g} times its derivative", velocity->column.column,
                               std::abs(found->ratio)));
      } else {
        size_by_range(*position);
      }
    }
    if (velocity && found)
      size_rate(*velocity, *position, *found, "the position");
    else if (velocity && velocity->size == 0.0)
      size_by_range(*velocity);
  }

  void size_acceleration() {
    UnscaledColumn* acceleration = find(Kind::acceleration);
    if (acceleration == nullptr) return;
    UnscaledColumn *velocity = find(Kind::velocity), *position = find(Kind::position);
    const UnscaledColumn* of = velocity ? velocity : position;
    std::optional<RateRatio> found;
    Values derived;
    if (velocity) {
      found = rate_ratio(*time_.raw, *velocity->raw, *acceleration->raw);
      // A velocity whose sign is turned turns what is compared with it.
      if (found && velocity->column.negative) found->ratio = -found->ratio;
    } else if (position) {
      derived = derivative(*time_.raw, *position->raw);
      found = rate_ratio(*time_.raw, derived, *acceleration->raw);
    }
    if (found && found->related()) {
      UnscaledColumn like = *of;
      if (velocity == nullptr) like.size /= time_.size;
      size_rate(*acceleration, like, *found,
                velocity ? "the velocity" : "the derivative of the position");
    } else if (acceleration->size == 0.0) {
      acceleration->set_unit(*stored_unit(Kind::acceleration, "m/s^2"));
      acceleration->guess("no unit in the header, and no velocity to infer it from");
    }
  }

  /// The unit of the derivative of `of`, which is `found.ratio` times that.
  void size_rate(UnscaledColumn& rate, const UnscaledColumn& of, const RateRatio& found,
                 const char* words) const {
    const double size = of.size / (std::abs(found.ratio) * time_.size);
    const std::string measured =
        fmt::format("{:.5g} times the derivative of {}", found.ratio, words);
    if (rate.size > 0.0 && std::abs(std::log(size / rate.size)) < kSameUnit) {
      rate.reason(fmt::format("{}, as expected for {}", measured, rate.named));
    } else if (rate.size > 0.0) {
      const StoredUnit* unit = unit_of_size(rate.column.kind, size);
      rate.guess(fmt::format("the header says {}, but it is {}: {}", rate.named, measured,
                             unit ? fmt::format("taken as {}", unit->text)
                                  : fmt::format("a factor of {:.4g} makes them agree", size)));
      unit ? rate.set_unit(*unit) : rate.set_unit(round_to_digits(size, 4));
    } else {
      from_ratio(rate, size, measured);
    }
    if (found.ratio > 0.0) return;
    rate.column.negative = true;
    rate.guess("its sign was inverted; if that is wrong, invert that of " + of.column.column);
  }

  static void from_ratio(UnscaledColumn& column, double size, const std::string& measured) {
    if (const StoredUnit* unit = unit_of_size(column.column.kind, size)) {
      column.set_unit(*unit);
      column.reason(fmt::format("{}: taken as {}", measured, unit->text));
    } else {
      column.set_unit(round_to_digits(size, 4));
      column.guess(fmt::format("{}: one unit is {:.4g} {}, which matches no known unit", measured,
                               size, si_unit(column.column.kind)));
    }
  }

  /// What nothing but the size of the values tells.
  static void size_by_range(UnscaledColumn& column) {
    const bool position = column.column.kind == Kind::position;
    const double range = largest(*column.raw);
    if (position && resolution_of(*column.raw) == 1.0 && range > 1e4) {
      column.set_unit(*stored_unit(Kind::position, "counts"));
      column.guess("whole numbers, taken as encoder counts: set the factor to metres per count");
      return;
    }
    const char* text = position ? (range < 10.0 ? "m" : "mm") : (range < 10.0 ? "m/s" : "mm/s");
    column.set_unit(*stored_unit(column.column.kind, text));
    column.guess(
        fmt::format("no unit in the header; values up to {:.4g}, taken as {}", range, text));
  }

  void size_other(UnscaledColumn& column) {
    const Kind kind = column.column.kind;
    const UnscaledColumn* measured = column.column.is_setpoint ? find(kind) : nullptr;
    if (measured != nullptr && measured->size > 0.0) {
      column.column.unit = measured->column.unit;
      column.column.factor = measured->column.factor;
      column.size = measured->size;
      column.guess(fmt::format("no unit in the header; same unit as {}", measured->column.column));
      return;
    }
    if (kind == Kind::position || kind == Kind::velocity) {
      size_by_range(column);
      return;
    }
    column.set_unit(stored_units(kind).front());
    column.guess(fmt::format("no unit in the header, taken as {}", column.column.unit));
  }

  /// What there is to say of units that a job cannot write.
  static void explain(UnscaledColumn& column) {
    const StoredUnit* unit = stored_unit(column.column.kind, column.named);
    if (unit == nullptr || unit->written == unit->text || column.size != unit->size) return;
    if (unit->text == "counts") {
      column.guess("encoder counts: set the factor to metres per count");
    } else if (is_part_of_rating(unit->text) && column.column.kind != Kind::command) {
      column.column.of_rating = true;
      column.guess(
          fmt::format("in per cent of the rated {}, taken as {} here: multiply the factor "
                      "by a hundredth of the rating",
                      column.column.kind == Kind::force ? "torque or force" : "current",
                      si_unit(column.column.kind)));
    } else if (column.column.kind == Kind::force)
      column.guess(fmt::format("in {}: converted with a lever of 1 m; divide the factor by r_g",
                               unit->text));
    else if (column.column.kind == Kind::command)
      column.guess(fmt::format("in {}, treated as V here", unit->text));
    else if (column.column.kind != Kind::acceleration || unit->text != "g")
      column.guess(fmt::format("in {}: 1 rad is treated as 1 m; multiply the factor by the radius",
                               unit->text));
  }

  static GuessedColumn finished(UnscaledColumn& column) {
    GuessedColumn result = std::move(column.column);
    const double size = column.size * (result.negative ? -1.0 : 1.0);
    for (const double x : *column.raw) result.values.push_back(x * size);
    return result;
  }

  const RecordingFile& file_;
  const std::string& path_;
  UnscaledColumn time_;
  std::map<Key, UnscaledColumn> columns_;
  std::vector<std::string> unused_, constant_;
};

}  // namespace

bool GuessedColumn::is_constant() const { return never_changes(values); }

const GuessedColumn* RecordingGuess::find(Kind kind, bool is_setpoint) const {
  for (const GuessedColumn& c : columns)
    if (c.kind == kind && c.is_setpoint == is_setpoint) return &c;
  return nullptr;
}

GuessedColumn* RecordingGuess::find(Kind kind, bool is_setpoint) {
  return const_cast<GuessedColumn*>(std::as_const(*this).find(kind, is_setpoint));
}

RecordingGuess guess_recording(const RecordingFile& file, const std::string& path) {
  return Guesser(file, path).guess();
}

}  // namespace axisfit
