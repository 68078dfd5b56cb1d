#include "io/recording/recording_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/plain_text.h"
#include "base/suggest.h"
#include "base/units.h"
#include "io/recording/csv.h"
#include "io/recording/mat_file.h"

namespace axisfit {

RecordingFile::RecordingFile(const std::string& path) : path_(path) {
  if (path.ends_with(".mat")) {
    MatFile mat = read_mat(path);
    for (Column& c : mat.columns) columns_.emplace(std::move(c.name), std::move(c.values));
    for (IgnoredVariable& v : mat.ignored) ignored_.emplace(std::move(v.name), std::move(v.kind));
  } else {
    Table table = read_csv(path);
    for (Column& c : table.columns) {
      units_.emplace(c.name, std::move(c.unit));
      columns_.emplace(std::move(c.name), std::move(c.values));
    }
    lines_ = std::move(table.lines);
  }
}

const std::vector<double>* RecordingFile::column(const ConfigNode& node) const {
  const auto name = node.as_string();
  if (!name) return nullptr;
  if (const auto found = columns_.find(*name); found != columns_.end()) {
    const std::vector<double>& values = found->second;
    // Nothing is measured beyond this in any unit, and squares of squares of residuals are finite.
    constexpr double kLargest = 1e30;
    const auto bad =
        std::ranges::find_if_not(values, [](double x) { return std::abs(x) <= kLargest; });
    if (bad == values.end()) return &values;
    const std::string place = where(static_cast<std::size_t>(bad - values.begin()));
    node.error(std::isfinite(*bad)
                   ? fmt::format("{}: '{}' has the impossible value {:g}: remove the row", place,
                                 *name, *bad)
                   : fmt::format("{}: '{}' is not finite: trim the recording or fill the gap",
                                 place, *name));
    return nullptr;
  }
  if (const auto ignored = ignored_.find(*name); ignored != ignored_.end()) {
    node.error(fmt::format("'{}' in {} is {}: export it as a numeric array", *name, path_,
                           ignored->second));
    return nullptr;
  }
  std::vector<std::string> names;
  for (const auto& [existing, values] : columns_) names.push_back(shortened(existing));
  const std::string suggestion = closest_match(*name, names);
  constexpr std::size_t kNamed = 30;
  const std::size_t more = names.size() - std::min(names.size(), kNamed);
  names.resize(names.size() - more);
  node.error(fmt::format("no column '{}' in {}; {}t has {}{}", *name, path_,
                         suggestion.empty() ? "i" : fmt::format("did you mean '{}'? I", suggestion),
                         fmt::join(names, ", "),
                         more > 0 ? fmt::format(" and {} more", more) : ""));
  return nullptr;
}

std::string RecordingFile::unit(const std::string& column) const {
  const auto found = units_.find(column);
  return found == units_.end() ? std::string() : found->second;
}

std::string RecordingFile::where(std::size_t row) const {
  return row < lines_.size() ? fmt::format("{}:{}", path_, lines_[row])
                             : fmt::format("{}: row {}", path_, row + 1);
}

const Section& column_keys() {
  static const Section keys{
      Key::required("column", Text{}, "name of the column, or of the MATLAB variable"),
      Key::required("unit", Text{}, "unit of the stored values"),
      Key::optional("factor", NumberWithUnit{"1", -1e12, 1e12}, 1.0,
                    "factor applied to the stored values"),
      Key::optional("sign", Choice{{{"1"}, {"-1"}}}, 0, "sign applied to the stored values")};
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
  const std::vector<double>* column = name ? file.column(*name) : nullptr;
  if (column == nullptr) return std::nullopt;
  std::vector<double> values = *column;
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
  constexpr double kShortest = 1e-9;  // s; beside the times themselves, shorter ones are rounding
  for (std::size_t i = 1; times && i < times->size(); ++i) {
    const double before = (*times)[i - 1], time = (*times)[i];
    if (time - before >= kShortest) continue;
    if (time > before) {
      node.error(fmt::format(
          "{}: {:.3g} s after the sample before, less than the {:g} s that a simulation can step: "
          "check the unit of time",
          file.where(i), time - before, kShortest));
      return std::nullopt;
    }
    node.error(
        fmt::format("{}: time {:.15g} s does not increase from {:.15g} s: samples must be in order "
                    "of time, without repeats",
                    file.where(i), time, before));
    return std::nullopt;
  }
  return times;
}

}  // namespace axisfit
