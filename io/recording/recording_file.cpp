#include "io/recording/recording_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/plain_text.h"
#include "base/suggest.h"
#include "base/units.h"
#include "io/recording/counters.h"
#include "io/recording/csv.h"
#include "io/recording/mat_file.h"
#include "io/recording/mcap_file.h"
#include "io/recording/xlsx_file.h"

namespace axisfit {

namespace {

/// Nothing is measured beyond this in any unit, and squares of squares of residuals are finite.
constexpr double kLargest = 1e30;

Table read_table(const std::string& path) {
  if (path.ends_with(".mat")) return read_mat(path);
  if (path.ends_with(".mcap")) return read_mcap(path);
  if (path.ends_with(".xlsx")) return read_xlsx(path);
  return read_csv(path);
}

/// The number from 1 that a text is; 0: it is none.
std::size_t column_number(const std::string& text) {
  std::size_t number = 0;
  const char* const end = text.data() + text.size();
  return std::from_chars(text.data(), end, number).ptr == end ? number : 0;
}

/// As the keys of a column say.
void correct_overflow(ConfigMap& map, const RecordingFile& file, std::vector<double>& values) {
  const auto is_beyond = [&](const ConfigNode& node, double low, double high, const char* what) {
    const auto beyond = std::ranges::find_if(values, [&](double x) { return x < low || x > high; });
    if (beyond == values.end()) return false;
    node.error(fmt::format("{}: {:.12g} {}", file.where(std::size_t(beyond - values.begin())),
                           *beyond, what));
    return true;
  };
  std::int64_t bits = 0;
  if (const auto given = map.read("signed_bits", bits); given && bits > 0)
    if (!is_beyond(*given, 0.0, std::ldexp(1.0, static_cast<int>(bits)) - 1.0,
                   "is no integer of so many bits without a sign: correct or remove signed_bits"))
      restore_sign(values, static_cast<int>(bits));
  double period = 0.0;
  const auto given = map.read("wraps_after", period);
  if (!given || period == 0.0) return;
  double least = INFINITY;
  for (const double x : values) least = std::fmin(least, x);  // passes over NaN
  constexpr double kRounding = 1e-6;
  if (!is_beyond(*given, -INFINITY, least + period * (1.0 + kRounding),
                 "is more than wraps_after beyond the least value: correct or remove it"))
    unwrap(values, period);
}

}  // namespace

RecordingFile::RecordingFile(const std::string& path) : table_(read_table(path)) {}

const Column* RecordingFile::column(const ConfigNode& node) const {
  const auto name = node.as_string();
  if (!name) return nullptr;
  const std::vector<Column>& columns = table_.columns;
  const auto called = [&](const Column& column) { return column.name == *name; };
  auto found = std::ranges::find_if(columns, called);
  if (found != columns.end()) {
    const auto again = std::find_if(found + 1, columns.end(), called);
    if (again != columns.end()) {
      node.error(fmt::format(
          "columns {} and {} of {} are both named '{}': give the number of the "
          "column instead of its name",
          found - columns.begin() + 1, again - columns.begin() + 1, table_.file, *name));
      return nullptr;
    }
  } else if (const std::size_t number = column_number(*name);
             number >= 1 && number <= columns.size()) {
    found = columns.begin() + static_cast<std::ptrdiff_t>(number - 1);
  } else {
    say_missing(node, *name);
    return nullptr;
  }
  if (!found->obstacle.empty()) {
    node.error(fmt::format("'{}' in {} {}", *name, table_.file, found->obstacle));
    return nullptr;
  }
  const auto bad =
      std::ranges::find_if(found->values, [](double x) { return std::abs(x) > kLargest; });
  if (bad == found->values.end()) return &*found;
  const std::string place = where(static_cast<std::size_t>(bad - found->values.begin()));
  node.error(std::isfinite(*bad)
                 ? fmt::format("{}: '{}' has the impossible value {:g}: remove the row", place,
                               *name, *bad)
                 : fmt::format("{}: '{}' is not finite: trim the recording or remove the row",
                               place, *name));
  return nullptr;
}

void RecordingFile::say_missing(const ConfigNode& node, const std::string& name) const {
  std::vector<std::string> names;
  for (const Column& column : table_.columns)
    if (!column.name.empty()) names.push_back(shortened(column.name));
  if (names.empty()) {
    node.error(
        fmt::format("no column '{}' in {}, whose columns have no names: give a number from "
                    "1 to {}",
                    name, table_.file, table_.columns.size()));
    return;
  }
  const std::string suggestion = closest_match(name, names);
  constexpr std::size_t kNamed = 30;
  const std::size_t more = names.size() - std::min(names.size(), kNamed);
  names.resize(names.size() - more);
  node.error(fmt::format("no column '{}' in {}; {}t has {}{}", name, table_.file,
                         suggestion.empty() ? "i" : fmt::format("did you mean '{}'? I", suggestion),
                         fmt::join(names, ", "),
                         more > 0 ? fmt::format(" and {} more", more) : ""));
}

std::string RecordingFile::reference(std::size_t column) const {
  const std::string& name = table_.columns[column].name;
  const bool own = !name.empty() && is_sanitized(name) && column_number(name) == 0 &&
                   std::ranges::count(table_.columns, name, &Column::name) == 1;
  return own ? name : std::to_string(column + 1);
}

const Section& column_keys() {
  static const Section keys{
      Key::required("column", Text{}, "its name, or its number from 1"),
      Key::required("unit", Text{}, "unit of the stored values"),
      Key::optional("factor", NumberWithUnit{"1", -1e12, 1e12}, 1.0,
                    "factor applied to the stored values"),
      Key::optional("sign", Choice{{{"1"}, {"-1"}}}, 0, "sign applied to the stored values"),
      Key::optional("wraps_after", NumberWithUnit{"1", 1e-9, 1e15}, DefaultText{"never"},
                    "what an encoder or counter shows of so much begins anew, in the unit of the "
                    "stored values, such as 360 or 65536: it is made continuous"),
      Key::optional("signed_bits", Integer{2, 52}, DefaultText{"the values have their sign"},
                    "signed integers of so many bits that were stored without their sign: of 16, "
                    "65535 is -1")};
  return keys;
}

std::optional<std::vector<double>> read_column(const RecordingFile& file, ConfigMap& map,
                                               std::string_view si_unit) {
  double factor = 1.0;
  if (const auto unit = map.required("unit")) {
    if (const auto text = unit->as_string()) {
      const auto conversion = unit_factor(*text, si_unit);
      if (const auto* problem = std::get_if<UnitError>(&conversion))
        unit->error(problem->message);
      else
        factor = std::get<double>(conversion);
    }
  }
  double further_factor = 1.0;
  std::size_t sign = 0;
  if (const auto given = map.read("factor", further_factor); given && further_factor == 0.0)
    given->error("factor must not be zero: it would erase the column");
  map.read("sign", sign);
  factor *= sign == 1 ? -further_factor : further_factor;
  const auto name = map.required("column");
  const Column* column = name ? file.column(*name) : nullptr;
  if (column == nullptr) return std::nullopt;
  std::vector<double> values = column->values;
  correct_overflow(map, file, values);
  for (double& x : values) x *= factor;
  return values;
}

std::optional<std::vector<double>> read_column(const RecordingFile& file, const ConfigNode& node,
                                               std::string_view si_unit) {
  ConfigMap map(node, column_keys());
  auto values = read_column(file, map, si_unit);
  map.finish();
  return values;
}

std::optional<std::vector<double>> read_times(const RecordingFile& file, const ConfigNode& node) {
  auto times = read_column(file, node, "s");
  double before = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; times && i < times->size(); ++i) {
    const double time = (*times)[i];
    if (std::isnan(time)) continue;
    if (time - before < kShortestStep) {
      node.error(
          time > before
              ? fmt::format("{}: {:.3g} s after the sample before, less than the {:g} s that a "
                            "simulation can step: check the unit of time",
                            file.where(i), time - before, kShortestStep)
              : fmt::format("{}: time {:.15g} s does not increase from {:.15g} s: samples must be "
                            "in order of time, without repeats",
                            file.where(i), time, before));
      return std::nullopt;
    }
    before = time;
  }
  return times;
}

}  // namespace axisfit
