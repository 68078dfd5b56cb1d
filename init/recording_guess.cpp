#include "init/recording_guess.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <ranges>

#include "base/plain_text.h"
#include "fit/data/noise.h"
#include "fit/data/recording_check.h"
#include "io/recording/csv.h"

namespace axisfit {
namespace {

using Values = std::vector<double>;
constexpr std::size_t kFewest = 10;  // samples of a recording, as the reader of jobs wants

double largest(const Values& values) {
  double size = 0.0;
  for (const double x : values) size = std::max(size, std::abs(x));
  return size;
}

bool increases(const Values& values) {
  return std::ranges::adjacent_find(values, std::greater_equal<>()) == values.end();
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
struct Unsized {
  GuessedColumn column;
  std::string named;  ///< unit in its name; empty: none
  double size = 0.0;  ///< of the unit in SI; zero: not known yet
  const Values* raw = nullptr;
  int rank = 0;

  void take(const StoredUnit& unit) {
    column.unit = unit.written;
    column.factor = unit.factor;
    size = unit.size;
  }
  void take(double any_size) {
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
    RecordingGuess result{path_, finished(time_), {}, std::move(unused_)};
    for (auto& [key, column] : columns_) {
      explain(column);
      result.columns.push_back(finished(column));
    }
    return result;
  }

 private:
  using Key = std::pair<Kind, bool>;

  static bool usable(const Values& values) {
    return values.size() >= kFewest &&
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
      if (!guess || guess->kind != Kind::time || !usable(values) || !is_harmless(name)) continue;
      if (time_.raw == nullptr || guess->rank > time_.rank) set_time(name, values, *guess);
    }
    if (time_.raw != nullptr) return;
    // One that increases at an even pace, as nothing else does.
    for (const auto& [name, values] : file_.columns()) {
      if (!usable(values) || !is_harmless(name) || !increases(values) ||
          sampling(values).jitter > 1e-3)
        continue;
      set_time(name, values, {});
      time_.guess("no name says time; this column increases at an even pace");
      return;
    }
    std::vector<std::string> names;
    for (const auto& [name, values] : file_.columns()) names.push_back(name);
    throw RecordingError(path_, 0,
                         fmt::format("no column can be the time of the samples; it has {}: name "
                                     "one of them time_s, or add one",
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
      if (!guess || guess->kind == Kind::time || !usable(values) || !is_harmless(name) ||
          values.size() != time_.raw->size()) {
        unused_.push_back(name);
        continue;
      }
      // A command is wanted by its nature.
      const bool command = guess->kind == Kind::command || guess->kind == Kind::set_velocity;
      const Key key{guess->kind, guess->wanted && !command};
      const auto there = columns_.find(key);
      if (there != columns_.end() && there->second.rank >= guess->rank) {
        unused_.push_back(name);
        continue;
      }
      if (there != columns_.end()) unused_.push_back(there->second.column.column);
      Unsized& column = columns_[key] = {};
      column.column.column = name;
      column.column.kind = key.first;
      column.column.wanted = key.second;
      column.named = guess->unit;
      column.raw = &values;
      column.rank = guess->rank;
    }
    if (!time_.named.empty()) time_.take(*stored_unit(Kind::time, time_.named));
    for (auto& [key, column] : columns_)
      if (!column.named.empty()) column.take(*stored_unit(key.first, column.named));
  }

  Unsized* find(Kind kind, bool wanted = false) {
    const auto at = columns_.find({kind, wanted});
    return at == columns_.end() ? nullptr : &at->second;
  }

  /// By the interval between samples, unless a position and a velocity of known units tell.
  void size_time() {
    if (time_.size > 0.0) return;
    const Unsized *position = find(Kind::position), *velocity = find(Kind::velocity);
    if (position && velocity && position->size > 0.0 && velocity->size > 0.0) {
      const auto found = rate_ratio(*time_.raw, *position->raw, *velocity->raw);
      if (found && found->related()) {
        const StoredUnit* unit =
            unit_of_size(Kind::time, position->size / (std::abs(found->ratio) * velocity->size));
        if (unit != nullptr) {
          time_.take(*unit);
          time_.reason(
              fmt::format("in {} the position changes as fast as the velocity says", unit->text));
          return;
        }
      }
    }
    const double interval = sampling(*time_.raw).interval;
    const char* text = interval < 0.05   ? "s"
                       : interval < 50.0 ? "ms"
                       : interval <= 1e4 ? "us"
                                         : "ns";
    time_.take(*stored_unit(Kind::time, text));
    time_.guess(fmt::format("no unit in the header; a sample each {:.4g}, in {} that is {:.4g} Hz",
                            interval, text, 1.0 / (interval * time_.size)));
  }

  /// Position and velocity: each tells the unit of the other.
  void size_motion() {
    Unsized *position = find(Kind::position), *velocity = find(Kind::velocity);
    std::optional<RateRatio> found;
    if (position && velocity) {
      found = rate_ratio(*time_.raw, *position->raw, *velocity->raw);
      if (found && !found->related()) {
        velocity->guess(
            fmt::format("it does not go along with the derivative of the position "
                        "(correlation {:.2f}): is it of the same axis?",
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
    Unsized* acceleration = find(Kind::acceleration);
    if (acceleration == nullptr) return;
    Unsized *velocity = find(Kind::velocity), *position = find(Kind::position);
    const Unsized* of = velocity ? velocity : position;
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
      Unsized like = *of;
      if (velocity == nullptr) like.size /= time_.size;
      size_rate(*acceleration, like, *found,
                velocity ? "the velocity" : "the derivative of the position");
    } else if (acceleration->size == 0.0) {
      acceleration->take(*stored_unit(Kind::acceleration, "m/s^2"));
      acceleration->guess("no unit in the header, and no velocity shows it");
    }
  }

  static double rounded(double size) { return std::stod(fmt::format("{:.4g}", size)); }

  /// The unit of the derivative of `of`, which is `found.ratio` times that.
  void size_rate(Unsized& rate, const Unsized& of, const RateRatio& found,
                 const char* words) const {
    const double size = of.size / (std::abs(found.ratio) * time_.size);
    const std::string measured =
        fmt::format("{:.5g} times the derivative of {}", found.ratio, words);
    if (rate.size > 0.0 && std::abs(std::log(size / rate.size)) < kSameUnit) {
      rate.reason(fmt::format("{}, as {} should be", measured, rate.named));
    } else if (rate.size > 0.0) {
      const StoredUnit* unit = unit_of_size(rate.column.kind, size);
      rate.guess(fmt::format("though the header says {} it is {}: {}", rate.named, measured,
                             unit ? fmt::format("taken as {}", unit->text)
                                  : fmt::format("a factor of {:.4g} makes them agree", size)));
      unit ? rate.take(*unit) : rate.take(rounded(size));
    } else {
      from_ratio(rate, size, measured);
    }
    if (found.ratio > 0.0) return;
    rate.column.negative = true;
    rate.guess("its sign is turned, or turn that of " + of.column.column);
  }

  static void from_ratio(Unsized& column, double size, const std::string& measured) {
    if (const StoredUnit* unit = unit_of_size(column.column.kind, size)) {
      column.take(*unit);
      column.reason(fmt::format("{}: taken as {}", measured, unit->text));
    } else {
      column.take(rounded(size));
      column.guess(fmt::format("{}, so that 1 of it is {:.4g} {}, which no unit is", measured, size,
                               si_unit(column.column.kind)));
    }
  }

  /// What nothing but the size of the values tells.
  static void size_by_range(Unsized& column) {
    const bool position = column.column.kind == Kind::position;
    const double range = largest(*column.raw);
    if (position && quantum(*column.raw) == 1.0 && range > 1e4) {
      column.take(*stored_unit(Kind::position, "counts"));
      column.guess("whole numbers, so counts of an encoder: make the factor the metres of a count");
      return;
    }
    const char* text = position ? (range < 10.0 ? "m" : "mm") : (range < 10.0 ? "m/s" : "mm/s");
    column.take(*stored_unit(column.column.kind, text));
    column.guess(
        fmt::format("no unit in the header; values up to {:.4g}, taken as {}", range, text));
  }

  void size_other(Unsized& column) {
    const Kind kind = column.column.kind;
    const Unsized* measured = column.column.wanted ? find(kind) : nullptr;
    if (measured != nullptr && measured->size > 0.0) {
      column.column.unit = measured->column.unit;
      column.column.factor = measured->column.factor;
      column.size = measured->size;
      column.guess(fmt::format("no unit in the header; as {}", measured->column.column));
      return;
    }
    if (kind == Kind::position || kind == Kind::velocity) {
      size_by_range(column);
      return;
    }
    column.take(stored_units(kind).front());
    column.guess(fmt::format("no unit in the header, taken as {}", column.column.unit));
  }

  /// What there is to say of units that a job cannot write.
  static void explain(Unsized& column) {
    const StoredUnit* unit = stored_unit(column.column.kind, column.named);
    if (unit == nullptr || unit->written == unit->text || column.size != unit->size) return;
    if (unit->text == "counts")
      column.guess("counts: make the factor the metres of one");
    else if (column.column.kind == Kind::force)
      column.guess(
          fmt::format("in {}: as if the lever were 1 m; divide the factor by r_g", unit->text));
    else if (column.column.kind == Kind::command)
      column.guess(fmt::format("in {}, which stand for V here", unit->text));
    else if (column.column.kind != Kind::acceleration || unit->text != "g")
      column.guess(
          fmt::format("in {}: 1 m stands for 1 rad, unless the factor is multiplied by "
                      "the radius",
                      unit->text));
  }

  static GuessedColumn finished(Unsized& column) {
    GuessedColumn result = std::move(column.column);
    const double size = column.size * (result.negative ? -1.0 : 1.0);
    for (const double x : *column.raw) result.values.push_back(x * size);
    return result;
  }

  const RecordingFile& file_;
  const std::string& path_;
  Unsized time_;
  std::map<Key, Unsized> columns_;
  std::vector<std::string> unused_;
};

}  // namespace

const GuessedColumn* RecordingGuess::find(Kind kind, bool wanted) const {
  for (const GuessedColumn& c : columns)
    if (c.kind == kind && c.wanted == wanted) return &c;
  return nullptr;
}

GuessedColumn* RecordingGuess::find(Kind kind, bool wanted) {
  return const_cast<GuessedColumn*>(std::as_const(*this).find(kind, wanted));
}

RecordingGuess guess_recording(const RecordingFile& file, const std::string& path) {
  return Guesser(file, path).guess();
}

}  // namespace axisfit
