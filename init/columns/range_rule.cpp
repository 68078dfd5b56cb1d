#include "init/columns/range_rule.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fit/data/recording_check.h"

namespace axisfit {
namespace {

bool are_whole(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double x) { return x == std::round(x); });
}

}  // namespace

void size_motion_by_range(UnscaledColumn& column, Joint joint, double range) {
  const Kind kind = column.column.kind;
  const bool is_place = kind == Kind::position || kind == Kind::load_position;
  const bool is_whole = is_place && are_whole(column.raw);
  if (const double turn = column.column.overflow.wraps_after; is_whole && turn > 0.0) {
    StoredUnit unit = *stored_unit(kind, "rev");
    unit.factor = 1.0 / turn;
    unit.size /= turn;
    column.set_unit(unit);
    column.guess(fmt::format("whole numbers, of which {:.6g} are taken as a turn", turn));
    return;
  }
  if (is_whole && range > 1e4) {
    column.set_unit(*stored_unit(kind, "counts"));
    column.guess("whole numbers, taken as encoder counts");
    return;
  }
  const bool is_large = range >= 10.0;
  const std::string_view length = is_large ? "mm" : "m", angle = is_large ? "deg" : "rad";
  const std::string text =
      fmt::format("{}{}", joint == Joint::revolute ? angle : length, is_place ? "" : "/s");
  column.set_unit(*stored_unit(kind, text));
  column.column.sized_by_range = true;
  column.guess(fmt::format("no unit in the header; values up to {:.4g}, taken as {}", range, text));
}

void size_duty_by_range(UnscaledColumn& column) {
  const double range = largest(column.raw);
  constexpr double kRounding = 1.001;
  double whole = 1.0;
  for (const double most : {1.0, 100.0, 255.0, 1023.0, 4095.0, 65535.0}) {
    whole = most;
    if (range <= most * kRounding) break;
  }
  // Registers hold whole numbers; what is not is a percentage at most.
  if (whole > 100.0 && !are_whole(column.raw)) whole = range;
  StoredUnit unit = *stored_unit(Kind::command, whole == 100.0 ? "%" : "1");
  if (whole == 100.0) {
    column.set_unit(unit);
  } else {
    unit.factor = unit.size = 1.0 / whole;
    column.set_unit(unit);
  }
  column.guess(
      fmt::format("no unit in the header; a duty up to {:.4g}, of which {:g} is taken as "
                  "the whole supply",
                  range, whole));
}

void size_time_by_interval(UnscaledColumn& time) {
  const Sampling pace = sampling(time.raw);
  const double interval = pace.interval;
  // A fraction of a millisecond between samples is no clock of milliseconds, unless the recording
  // lasts: at 10 Hz the interval is 0.1, too.
  constexpr double kShort = 500.0;
  const bool is_slow =
      interval < 1.0 && pace.duration < kShort && std::abs(time.raw.front()) < kShort;
  const char* text = interval < 0.05 || is_slow ? "s"
                     : interval < 50.0          ? "ms"
                     : interval <= 1e4          ? "us"
                                                : "ns";
  time.set_unit(*stored_unit(Kind::time, text));
  time.guess(fmt::format("no unit in the header; one sample every {:.4g}, taken as {}: {:.4g} Hz",
                         interval, text, 1.0 / (interval * time.size)));
}

bool is_supply(Kind kind, const std::vector<double>& values) {
  if (kind != Kind::command && kind != Kind::motor_voltage) return false;
  if (never_changes(values)) return false;  // as that of a step
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double square = 0.0;
  for (const double x : values) square += (x - mean) * (x - mean) / n;
  constexpr double kPart = 0.1;
  return std::sqrt(square) < kPart * std::abs(mean);
}

}  // namespace axisfit
