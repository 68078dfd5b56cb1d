#include "init/columns/heading.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/plain_text.h"

namespace axisfit {
namespace {

constexpr std::size_t kMinSamples = 10;  // of a recording, as the reader of jobs wants
constexpr std::size_t kMinChanges = 2;

bool is_usable(const Column& column) {
  if (!column.obstacle.empty()) return false;
  std::size_t there = 0;
  for (const double x : column.values) {
    if (std::isinf(x)) return false;
    there += !std::isnan(x);
  }
  // A clock of its own may tick where the values change alone.
  return there >= (column.clock ? kMinChanges : kMinSamples);
}

std::string shown(const Column& column, const std::string& reference, std::size_t c) {
  if (column.name.empty()) return fmt::format("column {}", c + 1);
  return column.name == reference ? column.name
                                  : fmt::format("{} (column {})", sanitized(column.name), c + 1);
}

const ColumnAnswer* answer_for(const std::vector<ColumnAnswer>& answers,
                               const std::string& reference, std::size_t c) {
  const ColumnAnswer* found = nullptr;
  for (const ColumnAnswer& answer : answers)
    if (answer.column == reference || answer.column == std::to_string(c + 1)) found = &answer;
  return found;
}

/// What the user says, and what the name adds: of which axis it is, and the unit where the user
/// says none.
ColumnGuess guess_of(const ColumnAnswer& answer, const std::optional<ColumnGuess>& named) {
  ColumnGuess guess;
  if (named) guess = *named;
  if (!named || named->kind != answer.kind || !answer.unit.empty()) guess.unit.clear();
  guess.kind = answer.kind;
  guess.is_setpoint = answer.is_setpoint;
  guess.is_measured = !answer.is_setpoint;
  guess.is_duty = answer.is_duty || (guess.is_duty && answer.unit.empty());
  guess.rank = kAnswered;
  return guess;
}

/// How much of the stored values is one turn, as far as the unit tells it.
std::optional<double> turn_of(const Heading& heading) {
  double factor = 1.0;
  std::string text = heading.guess->unit;
  if (heading.answer != nullptr && !heading.answer->unit.empty()) {
    text = heading.answer->unit;
    factor = std::abs(heading.answer->factor);
  }
  const auto unit = stored_unit(heading.guess->kind, text);
  const auto turn = stored_unit(heading.guess->kind, "rev");
  if (!unit || !turn || unit->joint != Joint::revolute) return std::nullopt;
  return turn->size / (unit->size * factor);
}

}  // namespace

std::string heading_text(const Column& column) {
  return column.unit.empty() ? column.name : fmt::format("{} [{}]", column.name, column.unit);
}

std::vector<Heading> headings_of(const RecordingFile& file, const std::string& path,
                                 const std::vector<ColumnAnswer>& answers) {
  std::vector<Heading> headings;
  std::vector<bool> is_clock(file.columns().size(), false);
  for (const Column& column : file.columns())
    if (column.clock) is_clock[*column.clock] = true;
  for (std::size_t c = 0; c < file.columns().size(); ++c) {
    const Column& column = file.columns()[c];
    Heading heading{
        file.reference(c), {}, guess_column(heading_text(column)), nullptr, is_usable(column)};
    heading.shown = shown(column, heading.reference, c);
    // "Time (/arm/position)" is a time whatever it is the time of.
    if (is_clock[c] && (!heading.guess || heading.guess->kind != Kind::time))
      heading.guess =
          guess_column(heading_text({.name = "time", .values = {}, .unit = column.unit}));
    heading.answer = answer_for(answers, heading.reference, c);
    if (heading.answer != nullptr) heading.guess = guess_of(*heading.answer, heading.guess);
    if (heading.answer != nullptr && !heading.is_usable)
      throw RecordingError(path, 0,
                           fmt::format("column '{}', which --column names, {}", heading.reference,
                                       column.obstacle.empty() ? "has fewer than 10 finite values"
                                                               : column.obstacle));
    if (heading.guess && heading.is_usable)
      heading.overflow =
          overflow_of(column.values, heading.guess->kind, turn_of(heading), heading.guess->unit);
    headings.push_back(std::move(heading));
  }
  return headings;
}

std::string described(const RecordingFile& file, const std::vector<Heading>& headings) {
  std::vector<std::string> names;
  for (std::size_t c = 0; c < headings.size(); ++c) {
    const std::string& obstacle = file.columns()[c].obstacle;
    names.push_back(obstacle.empty() ? shortened(headings[c].shown)
                                     : fmt::format("{} ({})", shortened(headings[c].shown),
                                                   shortened(obstacle)));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace axisfit
