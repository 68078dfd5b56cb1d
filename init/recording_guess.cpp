#include "init/recording_guess.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <ranges>
#include <stdexcept>
#include <tuple>

#include "base/plain_text.h"
#include "base/rounding.h"
#include "base/units.h"
#include "fit/data/noise.h"
#include "fit/data/recording_check.h"
#include "init/force_balance.h"

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

/// A voltage that hardly changes drives nothing: it is that of the supply.
bool is_supply(Kind kind, const Values& values) {
  if (kind != Kind::command && kind != Kind::motor_voltage) return false;
  if (never_changes(values)) return false;  // as that of a step
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double square = 0.0;
  for (const double x : values) square += (x - mean) * (x - mean) / n;
  constexpr double kPart = 0.1;
  return std::sqrt(square) < kPart * std::abs(mean);
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

/// Linear between the values that there are, constant beyond; those at NaN times are left out.
Values interpolated(const Values& times, const Values& values, const Values& at) {
  Values known_times, known;
  for (std::size_t i = 0; i < std::min(times.size(), values.size()); ++i) {
    if (std::isnan(times[i]) || std::isnan(values[i])) continue;
    known_times.push_back(times[i]);
    known.push_back(values[i]);
  }
  Values result;
  if (known.empty()) return result;
  std::size_t k = 0;
  for (const double t : at) {
    while (k < known_times.size() && known_times[k] < t) ++k;
    if (k == 0 || k == known_times.size()) {
      result.push_back(k == 0 ? known.front() : known.back());
      continue;
    }
    const double share = (t - known_times[k - 1]) / (known_times[k] - known_times[k - 1]);
    result.push_back(share == 1.0 ? known[k] : known[k - 1] + share * (known[k] - known[k - 1]));
  }
  return result;
}

Values without_gaps(const Values& values) {
  Values there;
  std::ranges::copy_if(values, std::back_inserter(there), [](double x) { return !std::isnan(x); });
  return there;
}

/// A column while its unit is looked for.
struct UnscaledColumn {
  GuessedColumn column;
  std::string named;  ///< unit in its name; empty: none
  double size = 0.0;  ///< of the unit in SI; zero: not known yet
  Values raw;         ///< at the times of the recording
  std::string shown;  ///< what messages call it
  int rank = 0;
  bool answered = false;  ///< by the user

  void set_unit(const StoredUnit& unit) {
    column.stored = unit.text;
    column.unit = unit.written;
    column.factor = unit.factor;
    size = unit.size;
  }
  void set_unit(double any_size) {
    column.stored.clear();
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
  Guesser(const RecordingFile& file, const std::string& path,
          const std::vector<ColumnAnswer>& answers, Joint joint)
      : file_(file), path_(path), joint_(joint) {
    read_headings(answers);
  }

  RecordingGuess guess() {
    find_time();
    find_columns();
    if (std::ranges::all_of(file_.columns(), [](const Column& c) { return c.name.empty(); }))
      infer_unnamed();
    size_time();
    size_motion();
    size_acceleration();
    for (auto& [key, column] : columns_)
      if (column.size == 0.0) size_other(column);
    explain(time_);
    std::vector<GuessedChannel> channels = find_channels();
    RecordingGuess result{
        path_, finished(time_), {}, std::move(unused_), std::move(constant_), std::move(channels)};
    for (auto& [key, column] : columns_) {
      explain(column);
      result.columns.push_back(finished(column));
    }
    return result;
  }

 private:
  using Key = std::pair<Kind, bool>;

  /// What is known of a column before its values are looked at.
  struct Heading {
    std::string reference;  ///< what a job calls it
    std::optional<ColumnGuess> guess;
    const ColumnAnswer* answer = nullptr;
    bool usable = false;
    Overflow overflow{};
  };

  static bool usable(const Column& column) {
    if (!column.obstacle.empty()) return false;
    std::size_t there = 0;
    for (const double x : column.values) {
      if (std::isinf(x)) return false;
      there += !std::isnan(x);
    }
    return there >= kMinSamples;
  }

  /// The name of a column, with its unit as if the name held it.
  static std::string heading_text(const Column& column) {
    return column.unit.empty() ? column.name : fmt::format("{} [{}]", column.name, column.unit);
  }

  /// What the header says of a column, with its unit as if the name held it; what the user says
  /// comes before.
  void read_headings(const std::vector<ColumnAnswer>& answers) {
    const std::vector<Column>& columns = file_.columns();
    clocks_.assign(columns.size(), false);
    for (const Column& column : columns)
      if (column.clock) clocks_[*column.clock] = true;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const Column& column = columns[c];
      Heading heading{file_.reference(c), {}, nullptr, usable(column)};
      heading.guess = guess_column(heading_text(column));
      // "Time (/arm/position)" is a time whatever it is the time of.
      if (is_clock(c) && (!heading.guess || heading.guess->kind != Kind::time))
        heading.guess =
            guess_column(heading_text({.name = "time", .values = {}, .unit = column.unit}));
      for (const ColumnAnswer& answer : answers) {
        if (answer.column != heading.reference && answer.column != std::to_string(c + 1)) continue;
        heading.answer = &answer;
        heading.guess = ColumnGuess{answer.kind, false, answer.unit, kAnswered};
        if (!heading.usable)
          throw RecordingError(
              path_, 0,
              fmt::format(
                  "column '{}', which --column names, {}", heading.reference,
                  column.obstacle.empty() ? "has fewer than 10 finite values" : column.obstacle));
      }
      if (heading.guess && heading.usable)
        heading.overflow = overflow_of(column.values, heading.guess->kind, heading.guess->unit);
      headings_.push_back(std::move(heading));
    }
  }

  void find_time() {
    const std::vector<Column>& columns = file_.columns();
    // Of several clocks the one that most columns go by; of those the densest.
    std::vector<std::size_t> followers(columns.size(), 0);
    for (const Column& column : columns)
      if (column.clock) ++followers[*column.clock];
    std::optional<std::size_t> best;
    const auto is_better = [&](std::size_t c) {
      const auto merit = [&](std::size_t i) {
        return std::tuple(
            headings_[i].guess->rank, followers[i],
            std::ranges::count_if(columns[i].values, [](double x) { return !std::isnan(x); }));
      };
      return !best || merit(c) > merit(*best);
    };
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const Heading& heading = headings_[c];
      if (heading.guess && heading.guess->kind == Kind::time && heading.usable && is_better(c))
        best = c;
    }
    if (best) {
      set_time(*best);
      return;
    }
    // One that increases at an even pace, as nothing else does. A count of samples does, too.
    for (const bool count : {false, true})
      for (std::size_t c = 0; c < columns.size() && !best; ++c) {
        if (!headings_[c].usable) continue;
        const Values values = without_gaps(columns[c].values);
        const Sampling pace = sampling(values);
        if (increases(values) && pace.jitter <= 1e-3 && (pace.interval == 1.0) == count) best = c;
      }
    if (best) {
      set_time(*best);
      time_.guess("no column is named as the time; this one increases evenly");
      return;
    }
    throw RecordingError(
        path_, 0,
        fmt::format("no column can be the sample time; the columns are {}. Say which it is by "
                    "--column time=COLUMN:s, or add one",
                    described_columns()));
  }

  /// What messages call a column: its name, with its number where a job needs that.
  std::string shown(std::size_t c) const {
    const std::string &name = file_.columns()[c].name, &reference = headings_[c].reference;
    if (name.empty()) return fmt::format("column {}", c + 1);
    return name == reference ? name : fmt::format("{} (column {})", sanitized(name), c + 1);
  }

  std::string described_columns() const {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < headings_.size(); ++c)
      names.push_back(file_.columns()[c].obstacle.empty()
                          ? shortened(shown(c))
                          : fmt::format("{} ({})", shortened(shown(c)),
                                        shortened(file_.columns()[c].obstacle)));
    return fmt::format("{}", fmt::join(names, ", "));
  }

  void set_time(std::size_t column) {
    time_ = {};
    time_column_ = column;
    time_.column.column = headings_[column].reference;
    time_.column.kind = Kind::time;
    time_.raw = without_gaps(file_.columns()[column].values);
    if (headings_[column].guess && headings_[column].guess->kind == Kind::time)
      apply_heading(column, time_);
  }

  /// The values of a column at the times of the recording; none where they cannot be.
  Values at_times(std::size_t c) const {
    const Column& column = file_.columns()[c];
    const std::size_t clock = column.clock.value_or(time_column_);
    const Values& times = file_.columns()[clock].values;
    if (times.size() != column.values.size() || !increases(without_gaps(times))) return {};
    Values values = column.values;
    headings_[c].overflow.undo(values);
    return interpolated(times, values, time_.raw);
  }

  /// What name or answer say of unit and factor.
  void apply_heading(std::size_t c, UnscaledColumn& column) const {
    const Heading& heading = headings_[c];
    column.rank = heading.guess->rank;
    column.named = heading.guess->unit;
    if (heading.answer == nullptr) {
      if (!column.named.empty()) column.set_unit(*stored_unit(column.column.kind, column.named));
      return;
    }
    column.answered = true;
    column.column.answer = heading.answer->column;
    column.column.stored = heading.answer->stored;
    column.column.unit = heading.answer->unit;
    column.column.factor = heading.answer->factor;
    column.column.of_rating = heading.answer->of_rating;
    column.size = heading.answer->factor *
                  std::get<double>(unit_factor(heading.answer->unit, si_unit(column.column.kind)));
  }

  void find_columns() {
    for (std::size_t c = 0; c < headings_.size(); ++c) {
      if (c == time_column_) continue;
      const Heading& heading = headings_[c];
      Values values;
      if (heading.guess && heading.guess->kind != Kind::time && heading.usable)
        values = at_times(c);
      if (values.empty()) {
        if (!is_clock(c)) unused_.push_back(shown(c));
        continue;
      }
      // A command is wanted by its nature.
      const bool command =
          heading.guess->kind == Kind::command || heading.guess->kind == Kind::set_velocity;
      const Key key{heading.guess->kind, heading.guess->is_setpoint && !command};
      const auto there = columns_.find(key);
      const bool constant = never_changes(values);
      if (constant && heading.answer == nullptr &&
          (!may_be_constant(key.first) || there != columns_.end())) {
        unused_.push_back(shown(c));
        constant_.push_back(shown(c));
        continue;
      }
      const bool supplies = is_supply(key.first, values);
      if (supplies && heading.answer == nullptr && channel_in(c)) {
        unused_.push_back(shown(c));
        continue;
      }
      const int rank = heading.guess->rank - (supplies ? kSupply : 0);
      if (there != columns_.end() && there->second.rank >= rank &&
          !never_changes(there->second.raw)) {
        unused_.push_back(shown(c));
        continue;
      }
      if (there != columns_.end()) unused_.push_back(there->second.shown);
      UnscaledColumn& column = add_column(c, key, std::move(values));
      apply_heading(c, column);
      column.rank = rank;
    }
  }

  std::optional<ChannelGuess> channel_in(std::size_t c) const {
    return guess_channel(heading_text(file_.columns()[c]));
  }

  /// Of what is unused and changes. It is used then.
  std::vector<GuessedChannel> find_channels() {
    std::vector<GuessedChannel> channels;
    for (std::size_t c = 0; c < headings_.size() && channels.size() < kChannels; ++c) {
      const Column& column = file_.columns()[c];
      const auto unused = std::ranges::find(unused_, shown(c));
      if (unused == unused_.end() || !headings_[c].usable) continue;
      if (column.clock && *column.clock != time_column_) continue;
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

  bool is_clock(std::size_t c) const { return clocks_[c]; }

  UnscaledColumn& add_column(std::size_t c, const Key& key, Values values) {
    UnscaledColumn& column = columns_[key] = {};
    column.column.column = headings_[c].reference;
    column.shown = shown(c);
    column.column.kind = key.first;
    column.column.is_setpoint = key.second;
    column.raw = std::move(values);
    column.column.overflow = headings_[c].overflow;
    if (const Overflow& of = column.column.overflow; of.signed_bits > 0)
      column.guess(fmt::format("its values at the top of {} bits are taken as those below zero",
                               of.signed_bits));
    else if (of.wraps_after > 0.0)
      column.guess(fmt::format("it leaps by about {:.6g}, taken as a turn: made continuous",
                               of.wraps_after));
    const auto& clock = file_.columns()[c].clock;
    // Columns that go by equal times share them.
    if (clock && *clock != time_column_ &&
        file_.columns()[*clock].values != file_.columns()[time_column_].values) {
      column.column.clock = headings_[*clock].reference;
      column.column.clock_unit = file_.columns()[*clock].unit;
    }
    return column;
  }

  /// Without a single name: a position is what another column is the rate of, and is no rate
  /// itself; what drives them is what goes best with their acceleration.
  void infer_unnamed() {
    std::map<std::size_t, Values> free;
    for (std::size_t c = 0; c < headings_.size(); ++c) {
      if (c == time_column_ || !headings_[c].usable || headings_[c].answer) continue;
      if (Values values = at_times(c); !values.empty() && !never_changes(values))
        free.emplace(c, std::move(values));
    }
    std::map<std::pair<std::size_t, std::size_t>, double>
        rates;  // how much the second is the first's
    for (const auto& [of, values] : free)
      for (const auto& [is, rate] : free)
        if (const auto found = rate_ratio(time_.raw, values, rate); found && of != is)
          rates[{of, is}] = std::abs(found->correlation);
    constexpr double kRelated = 0.95;
    const auto take = [&](std::size_t c, Kind kind, std::string reason) {
      UnscaledColumn& column = add_column(c, {kind, false}, free.at(c));
      column.guess(std::move(reason));
      std::erase(unused_, column.shown);
    };
    double best = kRelated;
    std::optional<std::pair<std::size_t, std::size_t>> motion;
    const bool moving = find(Kind::position) || find(Kind::velocity);
    for (const auto& [pair, correlation] : rates) {
      const bool is_rate = std::ranges::any_of(rates, [&, p = pair.first](const auto& r) {
        return r.first.second == p && r.second > kRelated;
      });
      if (moving || is_rate || correlation <= best) continue;
      best = correlation;
      motion = pair;
    }
    if (motion) {
      const auto [p, v] = *motion;
      take(p, Kind::position, "no column has a name; another one is its derivative");
      take(v, Kind::velocity, "no column has a name; it is the derivative of another one");
      free.erase(p);
      free.erase(v);
    }
    if (!find(Kind::position) && !find(Kind::velocity)) return;
    if (find(Kind::force) || find(Kind::current) || find(Kind::command)) return;
    const Values none;
    const UnscaledColumn *position = find(Kind::position), *velocity = find(Kind::velocity);
    std::optional<std::size_t> driver;
    best = 0.0;
    for (const auto& [c, values] : free) {
      const auto balance = force_balance(time_.raw, position ? position->raw : none,
                                         velocity ? velocity->raw : none, values);
      if (balance && balance->correlation > best) {
        best = balance->correlation;
        driver = c;
      }
    }
    if (driver)
      take(*driver, Kind::command,
           fmt::format("no column has a name; this one goes with the acceleration (correlation "
                       "{:.2f}), as what drives the axis does",
                       best));
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
      const auto found = rate_ratio(time_.raw, position->raw, velocity->raw);
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
    const double interval = sampling(time_.raw).interval;
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
      found = rate_ratio(time_.raw, position->raw, velocity->raw);
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
                               std::abs(found->ratio)),
                   is_of_angles(*velocity));
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
      found = rate_ratio(time_.raw, velocity->raw, acceleration->raw);
      // A velocity whose sign is turned turns what is compared with it.
      if (found && velocity->column.negative) found->ratio = -found->ratio;
    } else if (position) {
      derived = derivative(time_.raw, position->raw);
      found = rate_ratio(time_.raw, derived, acceleration->raw);
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
      const StoredUnit* unit = unit_of_size(rate.column.kind, size, is_of_angles(of));
      rate.guess(fmt::format("the header says {}, but it is {}: {}", rate.named, measured,
                             unit ? fmt::format("taken as {}", unit->text)
                                  : fmt::format("a factor of {:.4g} makes them agree", size)));
      unit ? rate.set_unit(*unit) : rate.set_unit(round_to_digits(size, 4));
    } else {
      from_ratio(rate, size, measured, is_of_angles(of));
    }
    if (found.ratio > 0.0) return;
    rate.column.negative = true;
    rate.guess("its sign was inverted; if that is wrong, invert that of " + of.column.column);
  }

  static bool is_of_angles(const UnscaledColumn& column) {
    const StoredUnit* unit = stored_unit(column.column.kind, column.column.stored);
    return unit != nullptr && axisfit::is_of_angles(*unit);
  }

  static void from_ratio(UnscaledColumn& column, double size, const std::string& measured,
                         bool of_angles) {
    if (const StoredUnit* unit = unit_of_size(column.column.kind, size, of_angles)) {
      column.set_unit(*unit);
      column.reason(fmt::format("{}: taken as {}", measured, unit->text));
    } else {
      column.set_unit(round_to_digits(size, 4));
      column.guess(fmt::format("{}: one unit is {:.4g} {}, which matches no known unit", measured,
                               size, si_unit(column.column.kind)));
    }
  }

  /// What nothing but the size of the values tells.
  void size_by_range(UnscaledColumn& column) const {
    const bool position = column.column.kind == Kind::position;
    const double range = largest(column.raw);
    if (position && resolution_of(column.raw) == 1.0 && range > 1e4) {
      column.set_unit(*stored_unit(Kind::position, "counts"));
      column.column.remark =
          "whole numbers, taken as encoder counts: set the factor to metres per count";
      return;
    }
    const bool is_large = range >= 10.0;
    const std::string_view length = is_large ? "mm" : "m", angle = is_large ? "deg" : "rad";
    const std::string text =
        fmt::format("{}{}", joint_ == Joint::revolute ? angle : length, position ? "" : "/s");
    column.set_unit(*stored_unit(column.column.kind, text));
    column.column.sized_by_range = true;
    column.guess(
        fmt::format("no unit in the header; values up to {:.4g}, taken as {}", range, text));
  }

  void size_other(UnscaledColumn& column) {
    const Kind kind = column.column.kind;
    const UnscaledColumn* measured = column.column.is_setpoint ? find(kind) : nullptr;
    if (measured != nullptr && measured->size > 0.0) {
      column.column.stored = measured->column.stored;
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
    std::string& remark = column.column.remark;
    if (unit->text == "counts") {
      remark = "encoder counts: set the factor to metres per count";
    } else if (is_part_of_rating(unit->text) && column.column.kind != Kind::command) {
      column.column.of_rating = true;
      remark = fmt::format(
          "{} {}, taken as {} here: multiply the factor "
          "by a hundredth of the rating",
          kInPercent, column.column.kind == Kind::force ? "torque or force" : "current",
          si_unit(column.column.kind));
    } else if (column.column.kind == Kind::force)
      remark =
          fmt::format("in {}: converted with a lever of 1 m; divide the factor by r_g", unit->text);
    else if (column.column.kind == Kind::command)
      remark = fmt::format("in {}, treated as V here", unit->text);
    else if (column.column.kind != Kind::acceleration || unit->text != "g")
      remark = fmt::format("in {}: 1 rad is treated as 1 m; multiply the factor by the radius",
                           unit->text);
  }

  static GuessedColumn finished(UnscaledColumn& column) {
    if (column.answered) {
      column.column.guessed = false;
      column.column.reasons.clear();
      column.column.remark.clear();
    }
    GuessedColumn result = std::move(column.column);
    const double size = column.size * (result.negative ? -1.0 : 1.0);
    for (const double x : column.raw) result.values.push_back(x * size);
    return result;
  }

  static constexpr int kAnswered = 1000;  ///< rank of what the user says
  static constexpr int kSupply = 100;     ///< by which a supply ranks lower

  const RecordingFile& file_;
  const std::string& path_;
  Joint joint_;
  std::vector<bool> clocks_;       ///< of each column: whether others go by it
  std::vector<Heading> headings_;  ///< of the columns of the file
  std::size_t time_column_ = 0;
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

ColumnAnswer read_answer(const std::string& text) {
  using enum Kind;
  static constexpr std::pair<std::string_view, Kind> kAnswerable[]{
      {"time", time},
      {"position", position},
      {"velocity", velocity},
      {"acceleration", acceleration},
      {"force", force},
      {"current", current},
      {"command", command},
      {"set_velocity", set_velocity},
      {"tachometer", tachometer},
      {"preamplifier_voltage", preamplifier_voltage},
      {"motor_voltage", motor_voltage}};
  const auto refuse = [&](const std::string& problem) {
    return std::runtime_error(
        fmt::format("--column {}: {}; write SIGNAL=COLUMN:UNIT, such as position=3:mm, "
                    "position=\"Geber [Ink]:um/8\" or force=Torque:N*0.2",
                    sanitized(text), problem));
  };
  const std::size_t equals = text.find('='), colon = text.rfind(':');
  if (equals == std::string::npos || colon == std::string::npos || colon < equals)
    throw refuse("the signal, the column or the unit is missing");
  const std::string signal = text.substr(0, equals);
  const auto* const known =
      std::ranges::find(kAnswerable, signal, [](const auto& s) { return s.first; });
  if (known == std::end(kAnswerable)) {
    std::vector<std::string_view> names;
    for (const auto& s : kAnswerable) names.push_back(s.first);
    throw refuse(
        fmt::format("there is no signal '{}', but {}", sanitized(signal), fmt::join(names, ", ")));
  }
  ColumnAnswer answer;
  answer.kind = known->second;
  answer.column = text.substr(equals + 1, colon - equals - 1);
  answer.unit = text.substr(colon + 1);
  // A factor, or a divisor, is a number behind the last sign.
  const std::size_t sign = answer.unit.find_last_of("*/");
  if (sign != std::string::npos) {
    const std::string number = answer.unit.substr(sign + 1);
    double factor = 0.0;
    const char* const end = number.data() + number.size();
    if (std::from_chars(number.data(), end, factor).ptr == end && !number.empty()) {
      if (!(std::abs(factor) > 0.0) || !std::isfinite(factor))
        throw refuse("the factor must be a number other than zero");
      answer.factor = answer.unit[sign] == '/' ? 1.0 / factor : factor;
      answer.unit.resize(sign);
    }
  }
  if (const StoredUnit* unit = stored_unit(answer.kind, answer.unit)) {
    answer.of_rating = is_part_of_rating(unit->text);
    answer.stored = unit->text;
    answer.unit = unit->written;
    answer.factor *= unit->factor;
  }
  const auto conversion = unit_factor(answer.unit, si_unit(answer.kind));
  if (const auto* problem = std::get_if<UnitError>(&conversion)) throw refuse(problem->message);
  return answer;
}

RecordingGuess guess_recording(const RecordingFile& file, const std::string& path,
                               const std::vector<ColumnAnswer>& answers, Joint joint) {
  return Guesser(file, path, answers, joint).guess();
}

namespace {

bool is_unit_of(std::string_view unit, std::string_view si_unit) {
  return std::holds_alternative<double>(unit_factor(unit, si_unit));
}

/// The same values in units of a turning load.
void write_turning_units(GuessedColumn& column) {
  const std::string_view wanted = unit_on(Joint::revolute, si_unit(column.kind));
  const StoredUnit* stored = stored_unit(column.kind, column.stored);
  if (stored == nullptr) {
    if (!is_unit_of(column.unit, wanted)) column.unit = wanted;
  } else if (is_unit_of(stored->text, wanted)) {
    column.unit = stored->text;
    column.factor /= stored->factor;
    column.remark.clear();
  } else {
    column.unit = wanted;
    column.factor *= stored->size / stored->factor;
    column.remark = words_on(Joint::revolute, column.remark);
  }
}

}  // namespace

bool is_of_angles(const RecordingGuess& recording) {
  bool any = false;
  for (const Kind kind : {Kind::position, Kind::velocity}) {
    const GuessedColumn* column = recording.find(kind);
    const StoredUnit* unit = column ? stored_unit(kind, column->stored) : nullptr;
    if (unit == nullptr || unit->text.starts_with("counts")) continue;
    if (!is_of_angles(*unit)) return false;
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
  const auto write = [&](GuessedColumn& column) {
    if (vocabulary.joint == Joint::revolute) write_turning_units(column);
    if (column.remark.empty()) return;
    column.reasons.push_back(std::exchange(column.remark, {}));
    column.guessed = true;
  };
  write(recording.time);
  std::ranges::for_each(recording.columns, write);
}

}  // namespace axisfit
