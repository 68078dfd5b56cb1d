#include "io/recording/csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <ostream>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "base/file_watch.h"
#include "base/plain_text.h"

namespace axisfit {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kHeaderAdvice = "; the first line must name the columns";

// Text of the file in quotes for a message, cut to a readable length.
std::string quote(std::string_view text) { return in_quotes(shortened(text, 40)); }

std::string counted(std::size_t count, std::string_view noun) {
  return std::to_string(count) + " " + std::string(noun) + (count == 1 ? "" : "s");
}

std::string read_whole_file(const std::string& path) {
  const FileWatch watch(path);
  check_readable(path);
  std::ifstream in(path, std::ios::binary);
  std::error_code gone;
  const std::uintmax_t size = std::filesystem::file_size(path, gone);
  std::string text(gone ? 0 : size, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) throw RecordingError(path, 0, "could not be read completely; check the disk");
  if (gone || watch.has_changed()) throw RecordingError(path, 0, FileWatch::kMessage);
  return text;
}

bool is_blank(std::string_view text) {
  return text.find_first_not_of(" \t") == std::string_view::npos;
}

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
}

// Whether it is a comment, as rigs and NumPy write them above the names of columns.
bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("% ") || line.starts_with("%%") ||
         line.starts_with("//");
}

std::string_view without_mark(std::string_view comment) {
  return trim(comment.substr(std::min(comment.find_first_not_of("#%/"), comment.size())));
}

bool begins_with_number(std::string_view text) {
  const std::size_t at = text.find_first_not_of(" \t\"+-.,");
  return at != std::string_view::npos && text[at] >= '0' && text[at] <= '9';
}

// Takes the lines off the front of a text, without their LF or CRLF, and counts them.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : remaining_(text) {}

  bool done() const { return remaining_.empty(); }
  std::size_t number() const { return number_; }  // of the line next() returned last, from 1

  std::string_view next() {
    const std::size_t end = std::min(remaining_.find('\n'), remaining_.size());
    std::string_view line = remaining_.substr(0, end);
    remaining_.remove_prefix(std::min(end + 1, remaining_.size()));
    ++number_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  std::string_view remaining() const { return remaining_; }
  // Takes a line of which this is the rest behind it.
  void take_to(const char* behind) {
    remaining_.remove_prefix(static_cast<std::size_t>(behind - remaining_.data()));
    ++number_;
  }

 private:
  std::string_view remaining_;
  std::size_t number_ = 0;
};

// Takes the fields off the front of a line, without the blanks and the quotes around them.
class FieldReader {
 public:
  FieldReader(std::string_view line, char delimiter) : remaining_(line), delimiter_(delimiter) {}

  bool done() const { return done_; }

  // Doubled quotes inside a quoted field stay doubled: numbers never have any. Returns nothing if
  // a quote is not closed or text follows the closing one; then the line cannot be split further.
  std::optional<std::string_view> next() {
    const std::size_t start = remaining_.find_first_not_of(delimiter_ == '\t' ? " " : " \t");
    if (start == std::string_view::npos || remaining_[start] != '"') return trim(cut());

    remaining_.remove_prefix(start + 1);
    std::size_t close = remaining_.find('"');
    while (close != std::string_view::npos && remaining_.substr(close + 1).starts_with('"')) {
      close = remaining_.find('"', close + 2);
    }
    if (close == std::string_view::npos) return std::nullopt;
    const std::string_view inside = remaining_.substr(0, close);
    remaining_.remove_prefix(close + 1);
    if (!is_blank(cut())) return std::nullopt;
    return trim(inside);
  }

 private:
  // Removes the text up to the next delimiter, and the delimiter.
  std::string_view cut() {
    const std::size_t end = remaining_.find(delimiter_);
    const std::string_view text = remaining_.substr(0, end);
    done_ = end == std::string_view::npos;
    remaining_.remove_prefix(done_ ? remaining_.size() : end + 1);
    return text;
  }

  std::string_view remaining_;
  char delimiter_;
  bool done_ = false;
};

char find_delimiter(std::string_view header) {
  bool quoted = false;
  std::string outside;
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    if (!quoted) outside += c;
  }
  for (const char delimiter : {',', ';', '\t'}) {
    if (outside.find(delimiter) != std::string::npos) return delimiter;
  }
  return ',';
}

enum class NumberError { kNone, kNotANumber, kNotFinite, kOutOfRange };

NumberError parse_number(std::string_view text, double& value) {
  // from_chars takes no plus sign, though it is common in hand-made files.
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);
  if (code == std::errc::invalid_argument || stop != end) return NumberError::kNotANumber;
  if (code == std::errc::result_out_of_range) return NumberError::kOutOfRange;
  return std::isfinite(value) ? NumberError::kNone : NumberError::kNotFinite;
}

// The text with a decimal point for its comma; empty if it has none, or more than that.
std::string with_point(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || text.find('.') != std::string_view::npos) return {};
  std::string point(text);
  point[comma] = '.';
  return point;
}

bool is_number(std::string_view text) {
  double value = 0;
  return parse_number(text, value) == NumberError::kNone;
}

std::string describe(NumberError error, std::string_view text) {
  if (text.empty()) {
    return "the field is empty; every row below the header must hold a number in every column";
  }
  if (error == NumberError::kNotFinite) {
    return quote(text) + " is not finite; remove the row or cut the recording there";
  }
  if (error == NumberError::kOutOfRange) {
    return quote(text) + " is out of the range of a double; choose another unit or fix the number";
  }
  const bool point = is_number(text);
  if (point || is_number(with_point(text))) {
    return quote(text) + " has a decimal " + (point ? "point" : "comma") +
           ", but numbers above it have a decimal " + (point ? "comma" : "point") +
           "; use one of them throughout";
  }
  return quote(text) + " is not a number; every row below the header must hold numbers";
}

[[noreturn]] void throw_bad_quotes(const std::string& file, std::size_t line, std::size_t field) {
  throw RecordingError(file, line,
                       "field " + std::to_string(field) +
                           ": the quotes are not balanced; close them before the next separator "
                           "and on the same line");
}

std::string unescape(std::string_view quoted) {
  std::string text(quoted);
  for (std::size_t at = text.find("\"\""); at != std::string::npos; at = text.find("\"\"", at)) {
    text.erase(at++, 1);
  }
  return text;
}

// How the lines of a file are made.
struct Format {
  char delimiter = ',';
  bool delimiter_at_end = false;
  char decimal = 0;  // the mark that the first number with one had
};

std::vector<Column> read_header(const std::string& file, std::size_t line_number,
                                std::string_view line, Format& format) {
  if (is_blank(line)) {
    throw RecordingError(file, line_number, "the line is blank" + std::string(kHeaderAdvice));
  }
  std::vector<Column> columns;
  for (FieldReader fields(line, format.delimiter); !fields.done();) {
    const std::size_t number = columns.size() + 1;
    const std::optional<std::string_view> field = fields.next();
    if (!field) throw_bad_quotes(file, line_number, number);
    std::string name = unescape(*field);
    format.delimiter_at_end = name.empty() && fields.done() && !columns.empty();
    if (format.delimiter_at_end) break;
    if (name.empty()) {
      throw RecordingError(
          file, line_number,
          "column " + std::to_string(number) + " has no name; name it or remove it");
    }
    columns.push_back({std::move(name), {}});
  }
  // Told before repeated names, which a row of numbers is likely to have.
  if (std::all_of(columns.begin(), columns.end(),
                  [](const Column& column) { return is_number(column.name); })) {
    throw RecordingError(file, line_number, "there are only numbers" + std::string(kHeaderAdvice));
  }
  std::unordered_map<std::string, std::size_t> numbers;  // position from 1 of each name
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto [first, is_new] = numbers.try_emplace(columns[i].name, i + 1);
    if (is_new) continue;
    throw RecordingError(file, line_number,
                         "columns " + std::to_string(first->second) + " and " +
                             std::to_string(i + 1) + " are both named " + quote(columns[i].name) +
                             "; give every column its own name");
  }
  return columns;
}

// Takes the units, if that is what the line holds: as many texts as there are columns, some of them
// perhaps empty, and not the beginning of a number among them.
bool read_units(std::string_view line, const Format& format, std::vector<Column>& columns) {
  std::vector<std::string> units;
  for (FieldReader fields(line, format.delimiter); !fields.done();) {
    const std::optional<std::string_view> field = fields.next();
    if (!field) return false;
    double value = 0;
    std::string_view text = *field;
    if (text.starts_with('+')) text.remove_prefix(1);
    if (std::from_chars(text.data(), text.data() + text.size(), value).ec !=
        std::errc::invalid_argument) {
      return false;
    }
    units.push_back(unescape(*field));
  }
  if (format.delimiter_at_end && !units.empty() && units.back().empty()) units.pop_back();
  if (units.size() != columns.size()) return false;
  if (std::all_of(units.begin(), units.end(), [](const auto& unit) { return unit.empty(); })) {
    return false;
  }
  for (std::size_t i = 0; i < units.size(); ++i) columns[i].unit = std::move(units[i]);
  return true;
}

// The number in a field, with the decimal mark of the file.
NumberError read_number(std::string_view text, Format& format, double& value) {
  const bool comma = format.delimiter != ',' && format.decimal != '.';
  if (comma && text.find(',') != std::string_view::npos) {
    const NumberError error = parse_number(with_point(text), value);
    if (error == NumberError::kNone) format.decimal = ',';
    return error;
  }
  const NumberError error = parse_number(text, value);
  if (format.decimal != '.' && text.find('.') != std::string_view::npos) {
    if (format.decimal == ',') return NumberError::kNotANumber;
    if (error == NumberError::kNone) format.decimal = '.';
  }
  return error;
}

std::size_t count_fields(std::string_view line, char delimiter) {
  std::size_t count = 0;
  // Behind quotes that are not balanced it cannot be split further.
  for (FieldReader fields(line, delimiter); !fields.done() && fields.next();) ++count;
  return count;
}

[[noreturn]] void throw_wrong_count(const Table& table, std::size_t line_number, std::size_t count,
                                    const Format& format) {
  const std::size_t expected = table.columns.size();
  const std::string sizes =
      counted(count, "field") + " for the " + counted(expected, "column") + " of the header";
  if (count < expected)
    throw RecordingError(table.file, line_number,
                         sizes + ", none for column " + quote(table.columns[count].name) +
                             "; complete or remove the row");
  throw RecordingError(
      table.file, line_number,
      sizes + ", more after column " + quote(table.columns.back().name) +
          (table.columns.front().name.find_first_of("#%") == 0 ? std::string(kHeaderAdvice)
           : expected > 1 && format.delimiter == ','
               ? "; name them or remove them; or, if these are decimal "
                 "commas, separate the fields by semicolons"
               : "; name them or remove them"));
}

void append_row(Table& table, std::size_t line_number, std::string_view line, Format& format) {
  FieldReader fields(line, format.delimiter);
  const std::size_t expected = table.columns.size();
  std::size_t count = 0;
  for (; !fields.done(); ++count) {
    const std::optional<std::string_view> field = fields.next();
    if (!field) throw_bad_quotes(table.file, line_number, count + 1);
    if (count == expected && format.delimiter_at_end && fields.done() && field->empty()) break;
    if (count >= expected) continue;  // go on counting for the message below
    Column& column = table.columns[count];
    double value = 0;
    const NumberError error = read_number(*field, format, value);
    if (error != NumberError::kNone) {
      if (const std::size_t all = count_fields(line, format.delimiter); all != expected)
        throw_wrong_count(table, line_number, all, format);
      const bool blanks = expected == 1 && field->find(' ') != std::string_view::npos;
      throw RecordingError(
          table.file, line_number,
          "column " + quote(column.name) + ": " +
              (blanks ? quote(*field) + " is not a number; separate the columns by commas, "
                                        "semicolons or tabs, not by spaces"
                      : describe(error, *field)));
    }
    column.values.push_back(value);
  }
  if (count != expected) throw_wrong_count(table, line_number, count, format);
  table.lines.push_back(line_number);
}

// Takes a line that holds nothing but numbers and delimiters, as nearly all do, in one go. Of any
// other it takes nothing.
bool append_plain_row(Table& table, LineReader& lines, const Format& format) {
  if (format.delimiter != ',' && format.decimal != '.') return false;
  const char* at = lines.remaining().data();
  const char* const end = at + lines.remaining().size();
  const std::size_t columns = table.columns.size();
  for (std::size_t c = 0; c < columns; ++c) {
    double value = 0;
    const auto [stop, code] = std::from_chars(at, end, value);
    const bool last = c + 1 == columns;
    at = stop + (last && stop != end && *stop == '\r');
    if (code != std::errc() || !std::isfinite(value) || at == end ||
        *at != (last ? '\n' : format.delimiter)) {
      for (std::size_t taken = 0; taken < c; ++taken) table.columns[taken].values.pop_back();
      return false;
    }
    table.columns[c].values.push_back(value);
    ++at;
  }
  lines.take_to(at);
  table.lines.push_back(lines.number());
  return true;
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
  const std::string content = read_whole_file(path);
  std::string_view text = content;
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    throw RecordingError(path, 0, "is UTF-16 text; save it as UTF-8 or plain ASCII");
  }
  if (text.starts_with("\x1F\x8B") || text.starts_with("PK\x03\x04")) {
    throw RecordingError(path, 0, "is compressed, not a text file; unpack or export it as CSV");
  }
  if (text.find('\0') != std::string_view::npos) {
    throw RecordingError(path, 0,
                         "is not a text file (it holds null bytes); export the recording as CSV "
                         "in UTF-8");
  }
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw RecordingError(path, 0, "the file is empty" + std::string(kHeaderAdvice));
  }

  Table table;
  table.file = path;
  LineReader lines(text);
  std::string_view header = lines.next(), comment;
  while (is_comment(header) && !lines.done()) {
    // The names may stand in the last comment: then numbers follow.
    comment = without_mark(header);
    if (begins_with_number(lines.remaining())) break;
    header = lines.next();
  }
  if (is_comment(header) && !comment.empty()) header = comment;
  const std::size_t header_line = lines.number();
  if (header.find('\r') != std::string_view::npos) {
    throw RecordingError(path, 1,
                         "lines end in a carriage return alone; save the file with line feeds");
  }
  Format format;
  format.delimiter = find_delimiter(header);
  table.columns = read_header(path, header_line, header, format);

  const auto line_ends = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  for (Column& column : table.columns) column.values.reserve(line_ends);
  table.lines.reserve(line_ends);

  std::size_t blank_line = 0;  // the first one that was not yet seen to be at the end of the file
  while (!lines.done()) {
    const bool below_units = lines.number() > header_line;
    if (below_units && blank_line == 0 && append_plain_row(table, lines, format)) continue;
    const std::string_view line = lines.next();
    if (is_blank(line)) {
      if (blank_line == 0) blank_line = lines.number();
      continue;
    }
    if (blank_line != 0) {
      throw RecordingError(path, blank_line,
                           "the line is blank, but rows follow; remove it, or complete the row");
    }
    if (lines.number() == header_line + 1 && read_units(line, format, table.columns)) continue;
    append_row(table, lines.number(), line, format);
  }
  if (table.rows() == 0) {
    throw RecordingError(path, header_line,
                         "there are no rows below the header; check how it was recorded");
  }
  return table;
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
