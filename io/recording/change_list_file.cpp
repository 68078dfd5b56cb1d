#include "io/recording/change_list_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/plain_text.h"
#include "io/recording/text_fields.h"
#include "io/recording/text_lines.h"

namespace axisfit {
namespace {

using Fields = std::vector<std::string>;

std::string lower_name(const std::string& field) {
  std::string name(without_brackets(field));
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

bool is_one_of(const std::string& name, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, name) != words.end();
}

/// The separator of a line that names a time, a key and a value; none: it is another line.
std::optional<char> separator_of(std::string_view line) {
  for (const char separator : {',', ';', '\t'}) {
    Fields fields;
    if (!split_fields(line, separator, fields) || fields.size() != 3) continue;
    for (std::string& field : fields) field = lower_name(field);
    if (is_one_of(fields[0], {"timestamp", "time", "date"}) &&
        is_one_of(fields[1], {"key", "name", "variable", "signal"}) && fields[2] == "value")
      return separator;
  }
  return std::nullopt;
}

std::string_view first_line(std::string_view text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
}

/// The values of a key.
struct Series {
  std::string name;
  std::vector<double> times, values;
  std::string obstacle;
};

class ListReader {
 public:
  explicit ListReader(const std::string& path) : path_(path), lines_(path) {}

  Table read() {
    std::string_view line;
    lines_.next(line);
    separator_ = separator_of(line).value_or(',');
    Fields fields;
    split_fields(line, separator_, fields);
    if (lower_name(fields.front()) == "timestamp") unit_ = "s";
    while (lines_.next(line)) {
      if (trimmed(line).empty()) continue;
      split_fields(line, separator_, fields);
      add(fields);
    }
    return finish();
  }

 private:
  void add(const Fields& fields) {
    double time = 0.0;
    if (fields.size() < 3 || fields[1].empty() ||
        read_field(fields[0], decimal(), time) != FieldKind::number)
      throw RecordingError(path_, lines_.number(),
                           fields.size() < 3 || !fields[1].empty()
                               ? "is no row of a time, a key and a value; complete or remove it"
                               : "has no key; complete or remove the row");
    if (parse_time(fields[0])) unit_ = "s";
    const auto [at, is_new] = numbers_.try_emplace(fields[1], all_.size());
    if (is_new) all_.push_back({in_utf8(fields[1]), {}, {}, {}});
    add_value(fields, time, all_[at->second]);
  }

  /// Texts have separators of their own, and no quotes where they are not closed.
  void add_value(const Fields& fields, double time, Series& series) const {
    if (!series.obstacle.empty()) return;
    double value = 0.0;
    const FieldKind kind =
        fields.size() == 3 ? read_field(fields[2], decimal(), value) : FieldKind::text;
    if (kind == FieldKind::missing) return;
    if (kind == FieldKind::number) {
      series.times.push_back(time);
      series.values.push_back(value);
      return;
    }
    series.obstacle = fmt::format("has {} in line {}, which is no finite number",
                                  in_quotes(shortened(fields[2], 40)), lines_.number());
    series.times = series.values = {};
  }

  char decimal() const { return separator_ == ',' ? '.' : ','; }

  Table finish() {
    if (all_.empty())
      throw RecordingError(path_, 0, "is a list of changes without any; check how it was exported");
    Table table{path_, {}};
    for (Series& series : all_) {
      if (series.obstacle.empty() && series.values.empty()) series.obstacle = "has no values";
      if (!series.obstacle.empty()) {
        table.columns.push_back({.name = series.name, .values = {}, .obstacle = series.obstacle});
        continue;
      }
      add_series(table,
                 {.name = fmt::format("Time ({})", series.name),
                  .values = std::move(series.times),
                  .unit = unit_},
                 {.name = series.name, .values = std::move(series.values)});
    }
    return table;
  }

  const std::string& path_;
  TextLines lines_;
  char separator_ = ',';
  std::string unit_;  ///< of the times
  std::vector<Series> all_;
  std::unordered_map<std::string, std::size_t> numbers_;  ///< of the keys
};

}  // namespace

bool is_change_list(std::string_view beginning) {
  const std::string_view names = first_line(beginning);
  // A long line is no such header, and would be taken apart for nothing.
  constexpr std::size_t kLongest = 200;
  if (names.size() > kLongest) return false;
  const auto separator = separator_of(names);
  if (!separator) return false;
  Fields fields;
  const std::size_t end = std::min(beginning.find('\n'), beginning.size() - 1);
  split_fields(first_line(beginning.substr(end + 1)), *separator, fields);
  double ignored = 0.0;
  return fields.size() < 2 || read_field(fields[1], ',', ignored) == FieldKind::text;
}

Table read_change_list(const std::string& path) { return ListReader(path).read(); }

}  // namespace axisfit
