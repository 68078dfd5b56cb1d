#include "io/recording/json_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/plain_text.h"
#include "io/recording/text_fields.h"
#include "io/recording/text_lines.h"

namespace axisfit {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kDeepest = 32;
constexpr std::size_t kMostColumns = 4096;
constexpr std::size_t kMostInArray = 64;
constexpr std::size_t kLongestName = 1000;
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::string_view without_blanks(std::string_view text) {
  return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

/// Takes the values of a text off the parser, one after the other, and makes columns of them: with
/// nothing in memory but these.
class Columns : public nlohmann::json_sax<Json> {
 public:
  explicit Columns(const std::string& path) : path_of_file_(path) {}

  /// Objects that stand by themselves are rows.
  void take_lines() { is_lines_ = true; }
  /// Bytes of text so far: missing values may be some times as many.
  void set_bytes(std::size_t bytes) { bytes_ = bytes; }
  /// Of the text that comes next; 0: not known.
  void set_line(std::size_t line) { line_ = line; }
  /// Where the last text was no JSON.
  std::size_t error_at() const { return error_at_; }

  /// Forgets what was begun in a text that was no JSON.
  void give_up() {
    frames_.clear();
    in_row_ = 0;
    name_.clear();
  }

  bool null() override { return add(kMissing); }
  bool boolean(bool value) override { return add(value ? 1.0 : 0.0); }
  bool number_integer(std::int64_t value) override { return add(static_cast<double>(value)); }
  bool number_unsigned(std::uint64_t value) override { return add(static_cast<double>(value)); }
  bool number_float(double value, const std::string&) override { return add(value); }
  bool string(std::string& text) override {
    double value = 0.0;
    const FieldKind kind = read_field(text, '.', value);
    return kind == FieldKind::number || kind == FieldKind::missing ? add(value)
                                                                   : add(kMissing, &text);
  }
  bool binary(Json::binary_t&) override { return true; }

  bool start_object(std::size_t) override {
    const bool is_row = in_row_ == 0 && (frames_.empty() ? is_lines_ : frames_.back().is_array);
    if (is_row) begin_row();
    push({.is_array = false, .is_row = is_row});
    return true;
  }
  bool key(std::string& key) override {
    name_.resize(frames_.back().name_size);
    if (!name_.empty()) name_ += '.';
    append(key);
    return true;
  }
  bool end_object() override {
    if (frames_.back().is_row) {
      ++tables_[table_].rows;
      in_row_ = 0;
    }
    return pop();
  }
  bool start_array(std::size_t) override {
    if (in_row_ == 0 && !frames_.empty() && frames_.back().is_array)
      refuse("has rows without names; make objects of them, as {\"time\": 0.0, \"position\": 0.1}");
    push({.is_array = true});
    return true;
  }
  bool end_array() override { return pop(); }

  bool parse_error(std::size_t at, const std::string&, const Json::exception&) override {
    error_at_ = at;
    return false;
  }

  /// All columns, each as long as its rows are many.
  Table finish() {
    Table table{path_of_file_, {}};
    for (Found& found : columns_) {
      if (found.table) resize(found.column.values, tables_[*found.table].rows);
      Column& column = found.column;
      if (column.obstacle.empty() &&
          std::ranges::all_of(column.values, [](double x) { return std::isnan(x); }))
        column.obstacle = "has no values";
      table.columns.push_back(std::move(column));
    }
    if (std::ranges::all_of(table.columns, [](const Column& c) { return !c.obstacle.empty(); }))
      refuse(
          "holds no numbers in rows or columns: it should be an array of objects, an object of "
          "arrays, or have an object in every line; see the page on recordings");
    return table;
  }

 private:
  struct Frame {
    bool is_array = false;
    bool is_row = false;
    bool is_ignored = false;              ///< behind the numbers of an array that are taken
    std::size_t name_size = 0;            ///< of the name of what it is
    std::size_t elements = 0;             ///< of an array, so far
    std::optional<std::size_t> column{};  ///< of an array that is one
    std::optional<std::size_t> table{};   ///< of an array of rows
  };
  struct Found {
    Column column;
    std::optional<std::size_t> table{};  ///< none: of an array that is a column
  };
  struct Rows {
    std::size_t rows = 0;
  };

  [[noreturn]] void refuse(const std::string& what) const {
    throw RecordingError(path_of_file_, line_, what);
  }

  void append(std::string_view text) {
    if (name_.size() + text.size() > kLongestName) refuse("has a name longer than 1000 bytes");
    name_ += text;
  }

  void push(Frame frame) {
    if (frames_.size() == kDeepest)
      refuse("is nested deeper than 32; is it a recording? Its rows should be simple objects");
    if (!frame.is_row) next_in_array();
    frame.is_ignored = is_ignored();
    frame.name_size = name_.size();
    frames_.push_back(frame);
    if (frame.is_row) in_row_ = frames_.size();
  }

  bool pop() {
    frames_.pop_back();
    name_.resize(frames_.empty() ? 0 : std::min(name_.size(), frames_.back().name_size));
    return true;
  }

  bool is_ignored() const {
    return !frames_.empty() &&
           (frames_.back().is_ignored ||
            (in_row_ != 0 && frames_.back().is_array && frames_.back().elements > kMostInArray));
  }

  /// Names an element of an array in a row.
  void next_in_array() {
    if (frames_.empty() || !frames_.back().is_array) return;
    Frame& array = frames_.back();
    name_.resize(array.name_size);
    if (in_row_ != 0 && array.elements < kMostInArray) append(fmt::format("[{}]", array.elements));
    ++array.elements;
  }

  /// Arrays of rows are tables of their own; so are all lines.
  void begin_row() {
    std::optional<std::size_t>& table = frames_.empty() ? table_of_lines_ : frames_.back().table;
    if (!table) {
      table = tables_.size();
      tables_.emplace_back();
    }
    table_ = *table;
    name_.resize(frames_.empty() ? 0 : frames_.back().name_size);
  }

  /// A value of the column that its name says; `text` where it is none.
  bool add(double value, const std::string* text = nullptr) {
    if (frames_.empty()) return true;
    const bool is_element = frames_.back().is_array;
    if (in_row_ == 0 && !is_element) return true;  // what is said about the recording
    next_in_array();
    if (is_ignored()) return true;
    if (in_row_ == 0) {
      std::optional<std::size_t>& column = frames_.back().column;
      if (!column) column = column_of({});
      append_to(columns_[*column].column, value, text);
      return true;
    }
    Column& column = columns_[column_of(table_)].column;
    const std::size_t row = tables_[table_].rows;
    if (column.values.size() > row) {  // a key twice, or the rest of a line that was given up
      column.values.resize(row);
    }
    resize(column.values, row);
    append_to(column, value, text);
    return true;
  }

  void append_to(Column& column, double value, const std::string* text) const {
    column.values.push_back(value);
    if (text != nullptr && column.obstacle.empty())
      column.obstacle = fmt::format("has {} as value {}, which is no finite number",
                                    in_quotes(shortened(*text, 40)), column.values.size());
  }

  std::size_t column_of(std::optional<std::size_t> table) {
    const auto [at, is_new] = numbers_.try_emplace(name_, columns_.size());
    if (is_new) {
      if (columns_.size() == kMostColumns)
        refuse("has more than 4096 columns; leave out those that are not of the axis");
      columns_.push_back({{.name = name_, .values = {}}, table});
    }
    return at->second;
  }

  /// Cuts the values, or fills them up with missing ones: in proportion to the text, since a few
  /// bytes could ask for very many.
  void resize(std::vector<double>& values, std::size_t rows) {
    if (rows > values.size()) {
      constexpr std::size_t kAlways = std::size_t{1} << 20, kPerByte = 4;
      missing_ += rows - values.size();
      if (missing_ > kAlways + kPerByte * bytes_)
        refuse(
            "has columns without a value in nearly all rows; leave them out, or write signals "
            "of different rates to files of their own");
    }
    values.resize(rows, kMissing);
  }

  const std::string& path_of_file_;
  bool is_lines_ = false;
  std::size_t bytes_ = 0, line_ = 0, error_at_ = 0, missing_ = 0;
  std::vector<Frame> frames_;
  std::size_t in_row_ = 0;  ///< frames to the row; 0: outside
  std::string name_;        ///< of what comes next, or of what holds it
  std::vector<Rows> tables_;
  std::optional<std::size_t> table_of_lines_;
  std::size_t table_ = 0;  ///< of the row
  std::vector<Found> columns_;
  std::unordered_map<std::string, std::size_t> numbers_;  ///< of the columns, by name
};

constexpr const char* kNoJson =
    "is no JSON from here on; export it again (NaN and Infinity are null in JSON)";

Table read_whole(const std::string& path, const std::string& text) {
  Columns columns(path);
  columns.set_bytes(text.size());
  if (!Json::sax_parse(text, &columns)) {
    const std::size_t end = std::min(columns.error_at(), text.size());
    const auto lines =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
    throw RecordingError(path, static_cast<std::size_t>(lines) + 1, kNoJson);
  }
  return columns.finish();
}

Table read_lines(const std::string& path, TextLines& lines) {
  Columns columns(path);
  columns.take_lines();
  std::vector<std::size_t> rows;
  std::size_t broken = 0;
  for (std::string_view line; lines.next(line);) {
    if (without_blanks(line).empty()) continue;
    // The last line may have been cut off; one that others follow was not.
    if (broken != 0) throw RecordingError(path, broken, kNoJson);
    columns.set_bytes(lines.bytes());
    columns.set_line(lines.number());
    if (!without_blanks(line).starts_with('{') ||
        !Json::sax_parse(line.begin(), line.end(), &columns)) {
      broken = lines.number();
      columns.give_up();
    } else {
      rows.push_back(lines.number());
    }
  }
  columns.set_line(0);
  Table table = columns.finish();
  table.lines = std::move(rows);
  return table;
}

/// Whether every line is an object by itself: the first one is, and something follows.
bool is_lines(std::string_view text) {
  text = without_blanks(text);
  const std::size_t end = text.find('\n');
  if (!text.starts_with('{') || end == std::string_view::npos ||
      without_blanks(text.substr(end)).empty())
    return false;
  // Quick to see, and what takes no memory.
  const std::string_view line = text.substr(0, text.find_last_not_of(" \t\r\n", end) + 1);
  return line.ends_with('}') && Json::accept(line.begin(), line.end());
}

}  // namespace

bool is_json(std::string_view beginning) {
  const std::string_view text = without_blanks(beginning);
  if (text.empty() || (text.front() != '{' && text.front() != '[')) return false;
  const std::string_view next = without_blanks(text.substr(1));
  if (text.front() == '{') return next.starts_with('"') || next.starts_with('}');
  // "[Header]" begins other files.
  return next.starts_with('{') || next.starts_with('[') || next.starts_with(']');
}

Table read_json(const std::string& path) {
  TextLines lines(path);
  return is_lines(lines.ahead()) ? read_lines(path, lines) : read_whole(path, lines.rest());
}

}  // namespace axisfit
