#include "io/recording/csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <ostream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/plain_text.h"
#include "io/recording/table_builder.h"
#include "io/recording/text_fields.h"
#include "io/recording/text_layout.h"
#include "io/recording/text_lines.h"

namespace axisfit {
namespace {

// Text of the file in quotes for a message, cut to a readable length.
std::string quote(std::string_view text) { return in_quotes(shortened(text, 40)); }

std::string counted(std::size_t count, std::string_view noun) {
  return std::to_string(count) + " " + std::string(noun) + (count == 1 ? "" : "s");
}

// Whether it is a comment, as rigs and NumPy write them above the names of columns.
bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("% ") || line.starts_with("%%") ||
         line.starts_with("//");
}

std::string_view without_mark(std::string_view comment) {
  return trimmed(comment.substr(std::min(comment.find_first_not_of("#%/"), comment.size())));
}

TextRow row_of(std::string_view line, std::size_t number, char separator) {
  TextRow row;
  row.line = number;
  row.is_comment = is_comment(line);
  row.balanced = split_fields(row.is_comment ? without_mark(line) : line, separator, row.fields);
  return row;
}

// The lines that tell the layout, without blank ones, and their numbers.
struct Head {
  std::vector<std::string> lines;
  std::vector<std::size_t> numbers;
  std::size_t bytes = 0;
};

Head read_head(TextLines& lines) {
  constexpr std::size_t kLines = 1000, kBytes = std::size_t{4} << 20;
  Head head;
  std::string_view line;
  while (head.lines.size() < kLines && head.bytes < kBytes && lines.next(line)) {
    head.bytes = lines.bytes();
    if (trimmed(line).empty()) continue;
    head.lines.emplace_back(line);
    head.numbers.push_back(lines.number());
  }
  return head;
}

// How many lines the rest of a file has, if they are as long as the first; a gzipped one has more.
std::size_t expected_lines(const std::string& path, const Head& head) {
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::file_size(path, ignored);
  if (ignored || head.bytes == 0) return 0;
  const double more = static_cast<double>(size) / static_cast<double>(head.bytes);
  return static_cast<std::size_t>(1.02 * more * static_cast<double>(head.numbers.back())) + 16;
}

std::string csv_field(const std::string& text) {
  // Beyond ASCII even the first bytes could pass for the mark of another encoding.
  const bool plain = std::all_of(text.begin(), text.end(), [](char c) {
    return c >= ' ' && c <= '~' && c != ',' && c != ';' && c != '"';
  });
  if (plain) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += c;
    quoted += c;
  }
  return quoted + '"';
}

void append_number(std::string& text, double value, int significant_digits) {
  if (std::isnan(value)) return;
  std::array<char, 32> buffer;  // sign, 17 digits, point, and an exponent of five take 24
  char* const begin = buffer.data();
  char* const end = begin + buffer.size();
  const std::to_chars_result result =
      significant_digits == 0
          ? std::to_chars(begin, end, value)
          : std::to_chars(begin, end, value, std::chars_format::general, significant_digits);
  text.append(begin, result.ptr);
}

}  // namespace

Table read_csv(const std::string& path) {
  TextLines lines(path);
  const Head head = read_head(lines);
  if (head.lines.empty())
    throw RecordingError(path, 0, "the file is empty; record or export it again");
  std::vector<std::string> data;
  for (const std::string& line : head.lines)
    if (!is_comment(line)) data.push_back(line);
  const char separator = find_separator(data);
  std::vector<TextRow> rows;
  for (std::size_t i = 0; i < head.lines.size(); ++i) {
    TextRow row = row_of(head.lines[i], head.numbers[i], separator);
    // One of separators alone is blank, too.
    if (std::ranges::any_of(row.fields, [](const std::string& field) { return !field.empty(); }))
      rows.push_back(std::move(row));
  }
  TextLayout layout = find_layout(path, rows, separator);
  const std::size_t first_row = layout.first_row;
  TableBuilder builder(path, std::move(layout));
  builder.expect_rows(expected_lines(path, head));
  for (std::size_t i = first_row; i < rows.size(); ++i)
    if (!rows[i].is_comment) builder.add(rows[i]);
  std::string_view line;
  while (lines.next(line)) {
    if (builder.add_plain(line, lines.number()) || is_comment(line)) continue;
    builder.add(row_of(line, lines.number(), separator));
  }
  return builder.finish();
}

void write_csv(std::ostream& out, const std::vector<Column>& columns, int significant_digits) {
  if (significant_digits < 0 || significant_digits > 17) {
    throw std::logic_error("write_csv: between 0 and 17 significant digits are possible");
  }
  const std::size_t rows = columns.empty() ? 0 : columns.front().values.size();
  for (const Column& column : columns) {
    if (column.values.size() == rows) continue;
    throw std::logic_error("write_csv: column " + quote(column.name) + " has " +
                           counted(column.values.size(), "value") + " in a table of " +
                           counted(rows, "row"));
  }

  std::string line;
  const auto write_line = [&](auto append_field) {
    line.clear();
    for (const Column& column : columns) {
      if (&column != &columns.front()) line += ',';
      append_field(column);
    }
    line += '\n';
    out.write(line.data(), static_cast<std::streamsize>(line.size()));
  };
  write_line([&](const Column& column) { line += csv_field(column.name); });
  for (std::size_t row = 0; row < rows; ++row) {
    write_line(
        [&](const Column& column) { append_number(line, column.values[row], significant_digits); });
  }
}

}  // namespace axisfit
