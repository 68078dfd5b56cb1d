#include "io/recording/table_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "base/plain_text.h"
#include "io/recording/text_fields.h"

namespace axisfit {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kShown = 40;  // bytes of a field in a message

std::string quoted(std::string_view text) { return in_quotes(shortened(text, kShown)); }

std::string obstacle_of(FieldKind kind, const std::string& field, char decimal, std::size_t line) {
  const std::string place = fmt::format("has {} in line {}, ", quoted(field), line);
  if (kind == FieldKind::infinite)
    return place + "which is not finite; remove the row or cut the recording there";
  if (kind == FieldKind::out_of_range)
    return place + "which is out of the range of a double; choose another unit or fix the number";
  double value = 0.0;
  if (read_field(field, decimal == '.' ? ',' : '.', value) == FieldKind::number)
    return place + fmt::format(
                       "with a decimal {}, but other numbers have a decimal {}; use one of "
                       "them throughout",
                       decimal == '.' ? "comma" : "point", decimal == '.' ? "point" : "comma");
  return place + "which is no number; correct it or leave the field blank";
}

}  // namespace

TableBuilder::TableBuilder(const std::string& path, TextLayout layout)
    : table_{path, std::move(layout.columns)}, layout_(std::move(layout)) {}

void TableBuilder::expect_rows(std::size_t rows) {
  for (Column& column : table_.columns) column.values.reserve(rows);
  table_.lines.reserve(rows);
}

bool TableBuilder::add_plain(std::string_view line, std::size_t number) {
  if (layout_.decimal != '.' || text_line_ != 0) return false;
  const char* at = line.data();
  const char* const end = at + line.size();
  const std::size_t columns = table_.columns.size();
  for (std::size_t c = 0; c < columns; ++c) {
    double value = 0;
    const auto [stop, code] = std::from_chars(at, end, value);
    const bool ends_well =
        c + 1 == columns ? stop == end : stop != end && *stop == layout_.separator;
    if (code != std::errc() || !std::isfinite(value) || !ends_well) {
      for (std::size_t taken = 0; taken < c; ++taken) table_.columns[taken].values.pop_back();
      return false;
    }
    table_.columns[c].values.push_back(value);
    at = stop + 1;
  }
  table_.lines.push_back(number);
  return columns > 0;
}

void TableBuilder::add(const TextRow& row) {
  const std::size_t columns = table_.columns.size();
  std::size_t filled = row.fields.size();
  while (filled > 0 && row.fields[filled - 1].empty()) --filled;
  if (filled == 0) return;
  const bool any_datum = std::ranges::any_of(row.fields, [](const std::string& field) {
    double value = 0.0;
    return !field.empty() && read_field(field, ',', value) != FieldKind::text;
  });
  if (!any_datum) {
    if (text_line_ == 0) {
      text_line_ = row.line;
      text_ = row.fields.front();
    }
    // A row of text in a table of several columns may be one of data that nobody uses; whether it
    // is, the row after it tells.
    return;
  }
  if (text_line_ != 0)
    throw RecordingError(table_.file, text_line_,
                         fmt::format("{} is no row of numbers, but rows follow; remove the line, "
                                     "or the rows of another recording",
                                     quoted(text_)));
  if (!row.balanced)
    throw RecordingError(table_.file, row.line,
                         fmt::format("field {}: the quotes are not balanced; close them before the "
                                     "next separator and on the same line",
                                     row.fields.size()));
  if (filled > columns || (row.fields.size() < columns && !layout_.series_end_early))
    throw_wrong_field_count(table_.file, row, table_.columns, layout_.separator);
  for (std::size_t c = 0; c < columns; ++c)
    add_field(c, c < row.fields.size() ? row.fields[c] : std::string(), row.line);
  table_.lines.push_back(row.line);
}

void TableBuilder::add_field(std::size_t c, const std::string& field, std::size_t line) {
  Column& column = table_.columns[c];
  double value = kMissing;
  const char decimal = layout_.decimal;
  FieldKind kind = read_field(field, decimal, value);
  // A decimal point where the others have a comma is as suspicious as the contrary.
  if (kind == FieldKind::number && decimal == ',' && field.find('.') != std::string::npos &&
      field.find(':') == std::string::npos) {
    kind = FieldKind::text;
    value = kMissing;
  }
  if (kind != FieldKind::number && kind != FieldKind::missing && column.obstacle.empty())
    column.obstacle = obstacle_of(kind, field, decimal, line);
  column.values.push_back(value);
}

Table TableBuilder::finish() {
  if (table_.lines.empty())
    throw RecordingError(table_.file, 0,
                         "there are no rows of numbers; check how it was recorded or exported");
  for (std::size_t c = 0; c < table_.columns.size(); ++c) {
    Column& column = table_.columns[c];
    if (layout_.intervals[c] > 0.0)
      for (double& x : column.values) x *= layout_.intervals[c];
    if (column.obstacle.empty() &&
        std::ranges::all_of(column.values, [](double x) { return std::isnan(x); }))
      column.obstacle = "has no values";
  }
  while (!table_.columns.empty() && table_.columns.back().name.empty() &&
         table_.columns.back().obstacle == "has no values")
    table_.columns.pop_back();
  return std::move(table_);
}

}  // namespace axisfit
