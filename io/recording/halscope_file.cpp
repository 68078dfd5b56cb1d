#include "io/recording/halscope_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <vector>

#include "base/plain_text.h"
#include "io/recording/text_fields.h"
#include "io/recording/text_lines.h"

namespace axisfit {
namespace {

using Fields = std::vector<std::string>;

constexpr std::string_view kBegins = "Sampling period is ";

std::string_view without_mark(std::string_view line) {
  return trimmed(line.starts_with('#') ? line.substr(1) : line);
}

class LogReader {
 public:
  explicit LogReader(const std::string& path) : path_(path), lines_(path), table_{path, {}} {}

  Table read() {
    std::string_view line;
    lines_.next(line);
    read_period(without_mark(line).substr(kBegins.size()));
    // Since the log has names above the values, the period is a comment.
    const bool names_above = line.starts_with('#');
    while (lines_.next(line)) {
      if (trimmed(line).empty() || line.starts_with('#')) continue;
      names_above ? add_below(line) : add_with_names(line);
    }
    if (!names_above && !table_.lines.empty()) drop_last();
    return finish();
  }

 private:
  void read_period(std::string_view text) {
    const auto [stop, code] = std::from_chars(text.data(), text.data() + text.size(), period_);
    const std::string_view unit = trimmed({stop, text.data() + text.size()});
    if (code != std::errc() || !(period_ > 0.0) || !unit.starts_with('n'))
      throw RecordingError(path_, 1, "the sampling period is no number of ns; save the log again");
    period_ *= 1e-9;
  }

  void add_below(std::string_view line) {
    split_fields(line, ';', fields_);
    if (table_.columns.empty())
      for (const std::string& name : fields_) table_.columns.push_back({in_utf8(name), {}});
    else
      add(fields_);
  }

  void add_with_names(std::string_view line) {
    split_fields(line, ' ', fields_);
    Fields values;
    for (std::size_t i = 1; i < fields_.size(); i += 2) values.push_back(fields_[i]);
    if (table_.columns.empty())
      for (std::size_t i = 0; i + 1 < fields_.size(); i += 2)
        table_.columns.push_back({in_utf8(fields_[i]), {}});
    add(values);
  }

  void add(const Fields& fields) {
    if (fields.size() != table_.columns.size())
      throw RecordingError(path_, lines_.number(),
                           fmt::format("has {} values for {} channels; remove the row, or save the "
                                       "log again",
                                       fields.size(), table_.columns.size()));
    for (std::size_t c = 0; c < fields.size(); ++c) {
      double value = 0.0;
      const FieldKind kind = read_field(fields[c], '.', value);
      if (kind != FieldKind::number && kind != FieldKind::missing)
        throw RecordingError(path_, lines_.number(),
                             fmt::format("{} is no finite number; remove the row, or save the log "
                                         "again",
                                         in_quotes(shortened(fields[c], 40))));
      table_.columns[c].values.push_back(value);
    }
    table_.lines.push_back(lines_.number());
  }

  void drop_last() {
    table_.lines.pop_back();
    for (Column& column : table_.columns) column.values.pop_back();
  }

  Table finish() {
    if (table_.lines.empty())
      throw RecordingError(path_, 0,
                           "is a log of halscope without samples; record, and save it again");
    Column time{.name = "time", .values = {}, .unit = "s"};
    for (std::size_t i = 0; i < table_.lines.size(); ++i)
      time.values.push_back(static_cast<double>(i) * period_);
    table_.columns.insert(table_.columns.begin(), std::move(time));
    return std::move(table_);
  }

  const std::string& path_;
  TextLines lines_;
  Table table_;
  Fields fields_;        ///< of the last line
  double period_ = 0.0;  ///< s
};

}  // namespace

bool is_halscope(std::string_view beginning) {
  return without_mark(beginning.substr(0, beginning.find('\n'))).starts_with(kBegins);
}

Table read_halscope(const std::string& path) { return LogReader(path).read(); }

}  // namespace axisfit
