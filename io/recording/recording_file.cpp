#include "io/recording/recording_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "base/plain_text.h"
#include "base/suggest.h"
#include "io/recording/change_list_file.h"
#include "io/recording/codesys_file.h"
#include "io/recording/csv.h"
#include "io/recording/halscope_file.h"
#include "io/recording/json_file.h"
#include "io/recording/mat_file.h"
#include "io/recording/mcap_file.h"
#include "io/recording/sysid_file.h"
#include "io/recording/text_lines.h"
#include "io/recording/wpilog_file.h"
#include "io/recording/xlsx_file.h"

namespace axisfit {

namespace {

/// Nothing is measured beyond this in any unit, and squares of squares of residuals are finite.
constexpr double kLargest = 1e30;

/// No recording of an axis has more, and what compares their names takes its time.
constexpr std::size_t kMostColumns = 16384;

Table read_table(const std::string& path) {
  if (path.ends_with(".mat")) return read_mat(path);
  if (path.ends_with(".mcap")) return read_mcap(path);
  if (path.ends_with(".xlsx")) return read_xlsx(path);
  if (is_wpilog(path)) return read_wpilog(path);
  const TextLines text(path);
  const std::string_view beginning = text.ahead();
  if (is_codesys(beginning)) return read_codesys(path);
  if (is_sysid(beginning)) return read_sysid(path, {});
  if (is_halscope(beginning)) return read_halscope(path);
  if (is_json(beginning)) return read_json(path);
  if (is_change_list(beginning)) return read_change_list(path);
  return read_csv(path);
}

/// One recording of several in a file.
Table read_one_of(const std::string& path, const std::string& name) {
  const TextLines text(path);
  if (is_sysid(text.ahead())) return read_sysid(path, name);
  throw RecordingError(path, 0,
                       fmt::format("holds one recording: leave '#{}' out of its name", name));
}

Table read_recording(const std::string& path) {
  const std::string file = file_of_recording(path);
  Table table = file == path ? read_table(path) : read_one_of(file, path.substr(file.size() + 1));
  if (table.columns.size() > kMostColumns)
    throw RecordingError(
        file, 0,
        fmt::format("has more than {} columns; export only the signals of the axis", kMostColumns));
  return table;
}

/// The number from 1 that a text is; 0: it is none.
std::size_t column_number(const std::string& text) {
  std::size_t number = 0;
  const char* const end = text.data() + text.size();
  return std::from_chars(text.data(), end, number).ptr == end ? number : 0;
}

}  // namespace

RecordingFile::RecordingFile(const std::string& path) : table_(read_recording(path)) {}

std::variant<const Column*, std::string> RecordingFile::column(const std::string& name) const {
  const std::vector<Column>& columns = table_.columns;
  const auto called = [&](const Column& column) { return column.name == name; };
  auto found = std::ranges::find_if(columns, called);
  if (found != columns.end()) {
    const auto again = std::find_if(found + 1, columns.end(), called);
    if (again != columns.end())
      return fmt::format(
          "columns {} and {} of {} are both named '{}': give the number of the "
          "column instead of its name",
          found - columns.begin() + 1, again - columns.begin() + 1, table_.file, name);
  } else if (const std::size_t number = column_number(name);
             number >= 1 && number <= columns.size()) {
    found = columns.begin() + static_cast<std::ptrdiff_t>(number - 1);
  } else {
    return missing(name);
  }
  if (!found->obstacle.empty())
    return fmt::format("'{}' in {} {}", name, table_.file, found->obstacle);
  const auto bad =
      std::ranges::find_if(found->values, [](double x) { return std::abs(x) > kLargest; });
  if (bad == found->values.end()) return &*found;
  const std::string place = where(static_cast<std::size_t>(bad - found->values.begin()));
  return std::isfinite(*bad)
             ? fmt::format("{}: '{}' has the impossible value {:g}: remove the row", place, name,
                           *bad)
             : fmt::format("{}: '{}' is not finite: trim the recording or remove the row", place,
                           name);
}

std::string RecordingFile::missing(const std::string& name) const {
  std::vector<std::string> names;
  for (const Column& column : table_.columns)
    if (!column.name.empty()) names.push_back(shortened(column.name));
  if (names.empty())
    return fmt::format(
        "no column '{}' in {}, whose columns have no names: give a number from 1 to {}", name,
        table_.file, table_.columns.size());
  const std::string suggestion = closest_match(name, names);
  constexpr std::size_t kNamed = 30;
  const std::size_t more = names.size() - std::min(names.size(), kNamed);
  names.resize(names.size() - more);
  return fmt::format("no column '{}' in {}; {}t has {}{}", name, table_.file,
                     suggestion.empty() ? "i" : fmt::format("did you mean '{}'? I", suggestion),
                     fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

std::string RecordingFile::reference(std::size_t column) const {
  const std::string& name = table_.columns[column].name;
  const bool own = !name.empty() && is_sanitized(name) && column_number(name) == 0 &&
                   std::ranges::count(table_.columns, name, &Column::name) == 1;
  return own ? name : std::to_string(column + 1);
}

std::string file_of_recording(const std::string& path) {
  std::error_code ignored;
  const std::size_t mark = path.rfind('#');
  if (mark == std::string::npos || std::filesystem::exists(path, ignored)) return path;
  const std::string file = path.substr(0, mark);
  return std::filesystem::is_regular_file(file, ignored) ? file : path;
}

}  // namespace axisfit
