#include "io/recording/text_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <span>

#include "base/plain_text.h"
#include "io/recording/table.h"
#include "io/recording/text_fields.h"
#include "io/recording/text_lines.h"

namespace axisfit {
namespace {

using Fields = std::vector<std::string>;

bool is_datum(FieldKind kind) { return kind != FieldKind::text; }

FieldKind kind_of(const std::string& field) {
  double ignored = 0.0;
  return read_field(field, ',', ignored);
}

std::size_t without_blank_end(const Fields& fields) {
  std::size_t count = fields.size();
  while (count > 0 && fields[count - 1].empty()) --count;
  return count;
}

/// Behind what a file begins with, down to where most of it is data.
template <class T>
std::span<const T> lower_part(const std::vector<T>& all) {
  constexpr std::size_t kLeast = 10;
  const std::size_t count = std::min(all.size(), std::max(kLeast, all.size() / 2));
  return std::span(all).last(count);
}

/// What rows of data have in common.
struct DataPattern {
  std::size_t least = 0, most = 0;  ///< fields, without and with blank ones at the end
  std::vector<bool> numeric;        ///< whether a column holds numbers rather than text

  bool holds(const TextRow& row) const {
    if (row.is_comment || !row.balanced || row.fields.size() > most) return false;
    std::size_t columns = 0, data = 0, numbers = 0;
    for (std::size_t c = 0; c < std::min(row.fields.size(), numeric.size()); ++c) {
      if (!numeric[c]) continue;
      const FieldKind kind = kind_of(row.fields[c]);
      // What stands left of a number in a preamble is its name.
      if (columns == 0 && !is_datum(kind)) return false;
      ++columns;
      data += is_datum(kind);
      numbers += kind == FieldKind::number;
    }
    const bool all_missing = data == columns && without_blank_end(row.fields) > 0;
    return columns > 0 && 2 * data >= columns && (numbers > 0 || all_missing);
  }
};

DataPattern find_pattern(const std::vector<TextRow>& rows) {
  const auto numbers_in = [](const TextRow& row) {
    return static_cast<std::size_t>(std::ranges::count_if(
        row.fields, [](const std::string& f) { return kind_of(f) == FieldKind::number; }));
  };
  DataPattern pattern;
  std::vector<int> balance;  // numbers less texts
  for (const TextRow& row : lower_part(rows)) {
    if (row.is_comment || numbers_in(row) == 0) continue;
    balance.resize(std::max(balance.size(), row.fields.size()));
    for (std::size_t c = 0; c < row.fields.size(); ++c) {
      const FieldKind kind = kind_of(row.fields[c]);
      balance[c] += (kind == FieldKind::number) - (kind == FieldKind::text);
    }
  }
  for (const int b : balance) pattern.numeric.push_back(b > 0);
  const auto first = std::ranges::find(pattern.numeric, true) - pattern.numeric.begin();
  // Series of fewer samples may have ended before the lower part.
  for (const TextRow& row : rows) {
    if (row.is_comment || std::ssize(row.fields) <= first ||
        !is_datum(kind_of(row.fields[static_cast<std::size_t>(first)])) || numbers_in(row) == 0)
      continue;
    pattern.least = std::max(pattern.least, without_blank_end(row.fields));
    pattern.most = std::max(pattern.most, row.fields.size());
  }
  return pattern;
}

/// A name that the tool gave to a channel, not the user.
bool is_generic(std::string_view name) {
  constexpr std::array<std::string_view, 7> kWords{"analog", "digital", "channel", "ch",
                                                   "column", "signal",  "trace"};
  std::string word;
  for (const char c : name)
    if (std::isalpha(static_cast<unsigned char>(c)))
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!std::isdigit(static_cast<unsigned char>(c)) && c != ' ' && c != '_' && c != '#')
      return false;
  return std::ranges::find(kWords, word) != kWords.end();
}

bool is_row_of_units(const Fields& fields) {
  std::size_t texts = 0, units = 0;
  for (const std::string& field : fields) {
    if (kind_of(field) == FieldKind::missing) continue;
    ++texts;
    units += is_unit(field);
  }
  return texts > 0 && 2 * units >= texts;
}

std::string unit_text(const std::string& field) {
  const std::string_view unit = without_brackets(field);
  return unit == "-" || unit == "None" ? std::string() : in_utf8(unit);
}

[[noreturn]] void throw_wrong_count(const std::string& path, const TextRow& names,
                                    const TextRow& data, char separator) {
  std::vector<Column> columns;
  for (std::size_t c = 0; c < without_blank_end(names.fields); ++c)
    columns.push_back({names.fields[c], {}});
  throw_wrong_field_count(path, data, columns, separator);
}

/// The index of the row of names, and below it perhaps one of units.
struct Header {
  std::size_t names = 0;
  std::optional<std::size_t> below;
};

std::optional<Header> find_header(const std::string& path, const std::vector<TextRow>& rows,
                                  std::size_t first_row, const DataPattern& pattern,
                                  char separator) {
  // A later row with too few or too many fields is no reason to doubt the names.
  const Fields& data = rows[first_row].fields;
  const std::size_t least = std::min(pattern.least, without_blank_end(data));
  const auto names_columns = [&](std::size_t i) {
    const std::size_t count = without_blank_end(rows[i].fields);
    return rows[i].balanced && count >= least && count <= pattern.most &&
           std::ranges::none_of(rows[i].fields, [](const std::string& f) {
             return kind_of(f) == FieldKind::number;
           });
  };
  const auto says_units = [&](std::size_t i) {
    return names_columns(i) ||
           (rows[i].fields.size() >= least && rows[i].fields.size() <= pattern.most + 1 &&
            is_row_of_units(rows[i].fields));
  };
  // A line of dashes, or a comment, may stand between names and data.
  constexpr std::size_t kNear = 3;
  for (std::size_t i = first_row; i-- > 0 && i + kNear >= first_row;) {
    if (!names_columns(i) && !says_units(i)) continue;
    const bool two = i > 0 && names_columns(i - 1);
    const Fields& upper = two ? rows[i - 1].fields : rows[i].fields;
    if (two && (is_row_of_units(rows[i].fields) || std::ranges::any_of(upper, is_generic)))
      return Header{i - 1, i};
    if (names_columns(i)) return Header{i, {}};
  }
  if (first_row == 0) return std::nullopt;
  const TextRow& above = rows[first_row - 1];
  if (!above.balanced)
    throw RecordingError(path, above.line,
                         fmt::format("field {}: the quotes are not balanced; close them before the "
                                     "next separator and on the same line",
                                     above.fields.size()));
  // A line of one field is a title, unless it is a name alone.
  const bool header = above.fields.size() > 1 ||
                      (first_row == 1 && above.fields.front().find(' ') == std::string::npos);
  if (header) throw_wrong_count(path, above, rows[first_row], separator);
  return std::nullopt;
}

void name_columns(const std::vector<TextRow>& rows, const Header& header, TextLayout& layout) {
  const Fields& names = rows[header.names].fields;
  for (std::size_t c = 0; c < std::min(names.size(), layout.columns.size()); ++c)
    layout.columns[c].name = in_utf8(names[c]);
  if (!header.below) return;
  const Fields& below = rows[*header.below].fields;
  for (std::size_t c = 0; c < std::min(below.size(), layout.columns.size()); ++c) {
    Column& column = layout.columns[c];
    if (is_generic(column.name) && !below[c].empty())
      column.name = in_utf8(below[c]);
    else
      column.unit = unit_text(below[c]);
  }
}

/// Rows that begin with what they hold: "Name;x;y;Name;z". Empty label: it holds something else.
std::string label_of(const TextRow& row) {
  std::string label;
  for (const char c : row.fields.empty() ? std::string() : row.fields.front())
    label += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return label;
}

/// The columns of a file whose rows begin with what they hold; false where it has none such. The
/// series between two labels share the times, or the counts, below the first.
bool read_labelled(const std::vector<TextRow>& rows, std::size_t first_row, TextLayout& layout) {
  // The last of each: the file itself may have a name, too. Of the units the first, where blanks
  // separate: "Unit ScaleFactor" follows.
  std::map<std::string, const TextRow*> labelled;
  for (std::size_t i = 0; i < first_row; ++i) {
    const std::string label = label_of(rows[i]);
    if (label != "unit" || !labelled.contains(label)) labelled[label] = &rows[i];
  }
  const auto row = [&](std::initializer_list<const char*> labels) -> const TextRow* {
    for (const char* label : labels)
      if (const auto found = labelled.find(label); found != labelled.end()) return found->second;
    return nullptr;
  };
  const TextRow* names = row({"channel name", "name"});
  const TextRow* const interval = row({"interval"});
  const TextRow* const sample_time = row({"sampletime[ms]"});
  const TextRow* const types = row({"data-type"});
  const TextRow* const symbols = row({"symbolname"});
  if (names == nullptr || (interval == nullptr && sample_time == nullptr)) return false;
  // Names with blanks cannot be told apart where blanks separate them; symbols have none, nor have
  // types.
  const TextRow* const widths = types ? types : names;
  const std::size_t count = without_blank_end(widths->fields);
  if (symbols != nullptr && without_blank_end(names->fields) != count) names = symbols;
  const std::string label = names->fields.front();
  std::size_t clock = 0;
  layout.columns.assign(count, {});
  layout.intervals.assign(count, 0.0);
  const auto field = [](const TextRow* of, std::size_t c) {
    return of != nullptr && c < of->fields.size() ? of->fields[c] : std::string();
  };
  const TextRow* const units = row({"unit"});
  // Where blanks separate, "V (Voltage)" is two fields.
  Fields unit_of(count);
  for (std::size_t c = 0, at = 0; units != nullptr && at < units->fields.size(); ++at) {
    const std::string& text = units->fields[at];
    if (c > 0 && text.starts_with('(') && text != "(None)" && units->fields.size() > count)
      continue;
    if (c < count) unit_of[c++] = text;
  }
  for (std::size_t c = 0; c < count; ++c) {
    Column& column = layout.columns[c];
    if (field(names, c) == label) {
      clock = c;
      const std::string of = c + 1 < count ? field(names, c + 1) : std::string();
      column.name = fmt::format("Time ({})", in_utf8(of));
      column.unit = sample_time ? "ms" : "s";
      double seconds = 0.0;
      if (interval && read_field(field(interval, c + 1), ',', seconds) == FieldKind::number)
        layout.intervals[c] = seconds;
      continue;
    }
    column.name = in_utf8(field(names, c));
    column.unit = unit_text(unit_of[c].substr(0, unit_of[c].find(" (")));
    column.clock = clock;
  }
  layout.series_end_early = true;
  return true;
}

char find_decimal(const std::vector<TextRow>& rows, std::size_t first_row) {
  for (std::size_t i = first_row; i < rows.size(); ++i)
    for (const std::string& field : rows[i].fields) {
      double value = 0.0;
      if (field.find(',') != std::string::npos && !parse_time(field) &&
          read_field(field, ',', value) == FieldKind::number)
        return ',';
      if (field.find('.') != std::string::npos && !parse_time(field) &&
          read_field(field, '.', value) == FieldKind::number)
        return '.';
    }
  return '.';
}

}  // namespace

char find_separator(const std::vector<std::string>& lines) {
  constexpr std::array<char, 6> kSeparators{',', ';', '\t', ' ', ':', '|'};
  constexpr std::size_t kUsual = 3;  // the first ones, preferred
  // Per line, a field that is a number counts for a separator, and text against it.
  constexpr double kText = 0.25, kClear = 0.2;
  std::array<double, kSeparators.size()> scores{};
  std::size_t counted = 0;
  for (const std::string& line : lower_part(lines)) {
    std::array<double, kSeparators.size()> here{};
    bool any = false;
    for (std::size_t s = 0; s < kSeparators.size(); ++s) {
      Fields fields;
      split_fields(line, kSeparators[s], fields);
      for (const std::string& field : fields) {
        const FieldKind kind = kind_of(field);
        any = any || kind == FieldKind::number;
        here[s] += kind == FieldKind::number || (kind == FieldKind::missing && !field.empty()) ? 1.0
                   : kind == FieldKind::text ? -kText
                                             : 0.0;
      }
    }
    if (!any) continue;
    ++counted;
    for (std::size_t s = 0; s < scores.size(); ++s) scores[s] += here[s];
  }
  std::size_t best = 0;
  for (std::size_t s = 1; s < scores.size(); ++s) {
    const double needed = s >= kUsual && best < kUsual ? kClear * double(counted) : 0.0;
    if (scores[s] > scores[best] + needed) best = s;
  }
  return kSeparators[best];
}

void throw_wrong_field_count(const std::string& path, const TextRow& row,
                             const std::vector<Column>& columns, char separator) {
  const std::size_t count = row.fields.size();
  const std::string sizes =
      fmt::format("{} field{} for the {} column{} of the header, ", count, count == 1 ? "" : "s",
                  columns.size(), columns.size() == 1 ? "" : "s");
  const auto name = [&](std::size_t c) {
    const std::string& given = columns[c].name;
    return given.empty() ? std::to_string(c + 1) : in_quotes(shortened(given, 40));
  };
  throw RecordingError(
      path, row.line,
      count < columns.size()
          ? fmt::format("{}none for column {}; complete or remove the row", sizes, name(count))
          : fmt::format("{}more after column {}; name them or remove them{}", sizes,
                        name(columns.size() - 1),
                        separator == ',' ? "; or, if these are decimal commas, separate the fields "
                                           "by semicolons"
                                         : ""));
}

TextLayout find_layout(const std::string& path, const std::vector<TextRow>& rows, char separator) {
  const DataPattern pattern = find_pattern(rows);
  TextLayout layout;
  layout.separator = separator;
  const auto first = std::ranges::find_if(rows, [&](const TextRow& r) { return pattern.holds(r); });
  if (first == rows.end())
    throw RecordingError(path, rows.empty() ? 0 : rows.back().line,
                         "there are no rows of numbers below this line; check how it was recorded "
                         "or exported");
  layout.first_row = static_cast<std::size_t>(first - rows.begin());
  layout.decimal = find_decimal(rows, layout.first_row);
  if (read_labelled(rows, layout.first_row, layout)) return layout;
  const auto header = find_header(path, rows, layout.first_row, pattern, separator);
  const std::size_t named = header ? without_blank_end(rows[header->names].fields) : 0;
  layout.columns.resize(header ? named : pattern.least);
  layout.intervals.assign(layout.columns.size(), 0.0);
  if (header) name_columns(rows, *header, layout);
  return layout;
}

}  // namespace axisfit
