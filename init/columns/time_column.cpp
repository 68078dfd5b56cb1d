#include "init/columns/time_column.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <tuple>

#include "fit/data/recording_check.h"
#include "io/config/recording_column.h"

namespace axisfit {
namespace {

using Values = std::vector<double>;

/// One that increases; of several clocks the one that most columns go by, of those the densest.
std::optional<std::size_t> named_time(const RecordingFile& file,
                                      const std::vector<Heading>& headings) {
  const std::vector<Column>& columns = file.columns();
  std::vector<std::size_t> followers(columns.size(), 0);
  for (const Column& column : columns)
    if (column.clock) ++followers[*column.clock];
  const auto merit = [&](std::size_t c) {
    return std::tuple(
        headings[c].answer != nullptr, increases(without_gaps(times_of_clock(file, c))),
        headings[c].guess->rank, followers[c],
        std::ranges::count_if(columns[c].values, [](double x) { return !std::isnan(x); }));
  };
  std::optional<std::size_t> best;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Heading& heading = headings[c];
    if (!heading.guess || heading.guess->kind != Kind::time || !heading.is_usable) continue;
    if (!best || merit(c) > merit(*best)) best = c;
  }
  return best;
}

/// One that increases as a clock does: nothing else is as even, but a count of samples.
std::optional<std::size_t> increasing_column(const RecordingFile& file,
                                             const std::vector<Heading>& headings) {
  constexpr double kEven = 1e-3, kJitter = 0.3;
  const auto first = [&](std::size_t end, auto&& suits) -> std::optional<std::size_t> {
    for (std::size_t c = 0; c < std::min(end, headings.size()); ++c) {
      if (!headings[c].is_usable || headings[c].answer != nullptr) continue;
      const Values values = without_gaps(file.columns()[c].values);
      if (increases(values) && suits(sampling(values))) return c;
    }
    return std::nullopt;
  };
  const std::size_t all = headings.size();
  const auto is_count = [](const Sampling& s) { return s.interval == 1.0 && s.jitter <= kEven; };
  if (const auto even =
          first(all, [&](const Sampling& s) { return s.jitter <= kEven && !is_count(s); }))
    return even;
  // Stamps of a host come late by a part of the interval. They stand in front.
  if (const auto stamps =
          first(2, [&](const Sampling& s) { return s.jitter <= kJitter && !is_count(s); }))
    return stamps;
  return first(all, is_count);
}

/// Throws where rows that differ have one time.
void refuse_repeats(const RecordingFile& file, const std::string& path, std::size_t clock,
                    const Heading& heading) {
  const Values times = times_of_clock(file, clock);
  std::vector<std::string> lines;
  std::size_t repeats = 0, before = times.size();
  bool is_back = false;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (std::isnan(times[i])) continue;
    if (before < times.size() && times[i] <= times[before]) {
      constexpr std::size_t kNamed = 3;
      is_back = is_back || times[i] < times[before];
      if (++repeats <= kNamed)
        lines.push_back(
            fmt::format("{} ({:.12g}, after {:.12g})", file.where(i), times[i], times[before]));
    }
    before = i;
  }
  if (repeats == 0) return;
  throw RecordingError(
      path, 0,
      fmt::format("{} does not increase in {} row{}: {}{}. {}", heading.shown, repeats,
                  repeats == 1 ? "" : "s", fmt::join(lines, ", "),
                  repeats > lines.size() ? ", ..." : "",
                  is_back ? "Remove or reorder these rows"
                          : "Rows that agree would count once, but these differ: remove the wrong "
                            "ones, or if the samples came at an even rate, say so by --rate \"1 "
                            "kHz\""));
}

}  // namespace

bool increases(const Values& values) {
  return std::ranges::adjacent_find(values, std::greater_equal<>()) == values.end();
}

Values without_gaps(const Values& values) {
  Values there;
  std::ranges::copy_if(values, std::back_inserter(there), [](double x) { return !std::isnan(x); });
  return there;
}

Values times_of_clock(const RecordingFile& file, std::size_t clock) {
  Values times = file.columns()[clock].values;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (repeats_row(file, i)) times[i] = std::nan("");
  return times;
}

Values even_times(const RecordingFile& file, double rate) {
  std::size_t samples = 0;
  for (const Column& column : file.columns()) samples = std::max(samples, column.values.size());
  Values times(samples);
  for (std::size_t i = 0; i < samples; ++i) times[i] = static_cast<double>(i) / rate;
  return times;
}

TimeColumn find_time(const RecordingFile& file, const std::string& path,
                     const std::vector<Heading>& headings, std::optional<double> rate) {
  TimeColumn time;
  time.column.column.kind = Kind::time;
  if (rate) {
    time.rate = *rate;
    time.column.set_unit(*stored_unit(Kind::time, "s"));
    time.column.raw = even_times(file, *rate);
    return time;
  }
  time.place = named_time(file, headings);
  const bool is_named = time.place.has_value();
  if (!is_named) time.place = increasing_column(file, headings);
  if (!time.place)
    throw RecordingError(
        path, 0,
        fmt::format("no column can be the sample time; the columns are {}. Say which it is by "
                    "--column time=COLUMN:s, or how many samples a second there are by --rate \"1 "
                    "kHz\"",
                    described(file, headings)));
  const Heading& heading = headings[*time.place];
  refuse_repeats(file, path, *time.place, heading);
  time.column.column.column = heading.reference;
  time.column.shown = heading.shown;
  time.column.raw = without_gaps(times_of_clock(file, *time.place));
  if (!is_named)
    time.column.guess("no column is named as the time; this one increases as a clock does");
  return time;
}

}  // namespace axisfit
