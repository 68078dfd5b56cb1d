#include "io/recording/codesys_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <pugixml.hpp>
#include <utility>
#include <vector>

#include "base/plain_text.h"
#include "io/recording/text_fields.h"
#include "io/recording/text_lines.h"

namespace axisfit {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view without_blanks(std::string_view text) {
  return text.substr(std::min(text.find_first_not_of(kBlanks), text.size()));
}

/// A variable with its samples.
class Series {
 public:
  Series(std::string name, int count)
      : name_(count == 1 ? std::move(name) : fmt::format("{}({})", name, count)) {}

  std::vector<double> times;

  /// A field in the decimal mark that it has.
  void add_value(std::string_view field) {
    double value = 0.0;
    const FieldKind kind = read_field(field, ',', value);
    if (kind != FieldKind::number && kind != FieldKind::missing && obstacle_.empty())
      obstacle_ = fmt::format("has {} as sample {}, which is no finite number",
                              in_quotes(shortened(field, 40)), values_.size() + 1);
    values_.push_back(value);
  }

  bool is_empty() const { return values_.empty() && times.empty(); }

  void finish(const std::string& unit, Table& table) && {
    if (obstacle_.empty() && values_.size() != times.size())
      obstacle_ = fmt::format("has {} values but {} times; save the trace again", values_.size(),
                              times.size());
    if (!obstacle_.empty()) {
      table.columns.push_back({.name = name_, .values = {}, .obstacle = obstacle_});
      return;
    }
    add_series(table, {.name = fmt::format("Time ({})", name_), .values = times, .unit = unit},
               {.name = name_, .values = std::move(values_)});
  }

 private:
  std::string name_;
  std::vector<double> values_;
  std::string obstacle_;
};

Table finished(const std::string& path, std::vector<Series> all, const std::string& unit) {
  Table table{path, {}};
  for (Series& series : all)
    if (!series.is_empty()) std::move(series).finish(unit, table);
  if (table.columns.empty())
    throw RecordingError(path, 0,
                         "is a trace of CODESYS without samples; record it, and save it again from "
                         "the trace editor as .trace or .csv");
  return table;
}

/// Calls `take` for the fields between commas.
template <class Take>
void for_each_field(std::string_view text, Take&& take) {
  if (without_blanks(text).empty()) return;
  for (bool more = true; more;) {
    const std::size_t end = text.find(',');
    take(trimmed(text.substr(0, end)));
    more = end != std::string_view::npos;
    if (more) text.remove_prefix(end + 1);
  }
}

/// Of the times of all variables; empty where the trace does not say it.
std::string unit_in(const pugi::xml_node& configuration) {
  const pugi::xml_node found = configuration.find_node([](const pugi::xml_node& node) {
    return std::string_view(node.attribute("Name").value()) == "MicroSeconds";
  });
  const std::string_view says = found.child_value();
  return says == "True" || says == "true" ? "us" : says.empty() ? "" : "ms";
}

Table read_xml(const std::string& path, std::string text) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer_inplace(
      text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result)
    throw RecordingError(path, 0,
                         fmt::format("is a trace of CODESYS that breaks off or is damaged near "
                                     "byte {} of its text; save the trace again",
                                     result.offset));
  const pugi::xml_node root = document.child("Trace");
  std::vector<Series> all;
  std::map<std::string, int> of_name;
  for (const pugi::xml_node& record : root.child("TraceData").children("TraceRecord"))
    for (const pugi::xml_node& variable : record.children("TraceVariable")) {
      const std::string name = variable.attribute("VarName").value();
      Series& series = all.emplace_back(name, ++of_name[name]);
      for_each_field(variable.child_value("Values"),
                     [&](std::string_view field) { series.add_value(field); });
      for_each_field(variable.child_value("Timestamps"), [&](std::string_view field) {
        double time = 0.0;
        if (read_field(field, '.', time) != FieldKind::number)
          throw RecordingError(
              path, 0,
              fmt::format("the variable {} has the time {}, which is no number; "
                          "save the trace again",
                          in_quotes(shortened(name)), in_quotes(shortened(field, 40))));
        series.times.push_back(time);
      });
    }
  return finished(path, std::move(all), unit_in(root.child("TraceConfiguration")));
}

/// What the flags of a trace say of the unit of its times.
std::string unit_of_flags(std::string_view text) {
  unsigned flags = 0;
  std::from_chars(text.data(), text.data() + text.size(), flags);
  const bool ms = (flags & 16U) != 0, us = (flags & 32U) != 0;
  return ms == us ? "" : ms ? "ms" : "us";
}

/// Lines "key; value", and for the samples of a variable below "3.Variable; name" and so on
/// "; time; value".
Table read_keys(const std::string& path, TextLines& lines) {
  std::vector<Series> all;
  std::map<std::string, int> of_name;
  std::string unit;
  for (std::string_view line; lines.next(line);) {
    const std::size_t mark = line.find(';');
    if (mark == std::string_view::npos) continue;
    const std::string_view key = trimmed(line.substr(0, mark));
    const std::string_view value = trimmed(line.substr(mark + 1));
    if (key == "Flags") unit = unit_of_flags(value);
    if (key.ends_with(".Variable")) {
      const std::string name = in_utf8(value);
      all.emplace_back(name, ++of_name[name]);
    }
    if (!key.empty()) continue;
    const std::size_t second = value.find(';');
    double time = 0.0;
    if (all.empty() || second == std::string_view::npos ||
        read_field(value.substr(0, second), ',', time) != FieldKind::number)
      throw RecordingError(path, lines.number(),
                           all.empty()
                               ? "there is a sample before any variable; save the trace "
                                 "again"
                               : "is no sample of a time and a value; save the trace again");
    all.back().times.push_back(time);
    all.back().add_value(trimmed(value.substr(second + 1)));
  }
  return finished(path, std::move(all), unit);
}

}  // namespace

bool is_codesys(std::string_view beginning) {
  const std::string_view text = without_blanks(beginning).substr(0, 4096);
  if (text.starts_with("[key];")) return true;
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  return text.starts_with('<') && (has("<Trace>") || has("<Trace ")) &&
         (has("<TraceConfiguration") || has("<TraceData"));
}

Table read_codesys(const std::string& path) {
  TextLines lines(path);
  return without_blanks(lines.ahead()).starts_with('<') ? read_xml(path, lines.rest())
                                                        : read_keys(path, lines);
}

}  // namespace axisfit
