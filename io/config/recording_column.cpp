#include "io/config/recording_column.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.h"
#include "io/recording/counters.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

/// Null, with a diagnostic, where there is none that can be used.
const Column* column_at(const ConfigNode& node, const RecordingFile& file) {
  const auto name = node.as_string();
  if (!name) return nullptr;
  const auto found = file.column(*name);
  if (const auto* column = std::get_if<const Column*>(&found)) return *column;
  node.error(std::get<std::string>(found));
  return nullptr;
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
  const Column* column = name ? column_at(*name, file) : nullptr;
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

bool repeats_row(const RecordingFile& file, std::size_t row) {
  // Times alone would have nothing that agrees.
  return row > 0 && file.columns().size() > 1 &&
         std::ranges::all_of(file.columns(), [row](const Column& column) {
           if (row >= column.values.size()) return true;
           const double before = column.values[row - 1], now = column.values[row];
           return before == now || (std::isnan(before) && std::isnan(now));
         });
}

std::optional<std::vector<double>> read_times(const RecordingFile& file, const ConfigNode& node) {
  auto times = read_column(file, node, "s");
  double before = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; times && i < times->size(); ++i) {
    double& time = (*times)[i];
    if (std::isnan(time)) continue;
    if (time == before && repeats_row(file, i)) {
      time = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
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
