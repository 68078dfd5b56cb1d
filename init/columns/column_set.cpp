#include "init/columns/column_set.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/plain_text.h"

namespace axisfit {

bool is_number(const std::string& word) {
  return !word.empty() && word.find_first_not_of("0123456789") == std::string::npos;
}

bool never_changes(const std::vector<double>& values) {
  return std::ranges::adjacent_find(values, std::not_equal_to<>()) == values.end();
}

double largest(const std::vector<double>& values) {
  double size = 0.0;
  for (const double x : values) size = std::max(size, std::abs(x));
  return size;
}

bool GuessedColumn::is_constant() const { return never_changes(values); }

std::string GuessedColumn::title() const {
  return sanitized(shortened(is_number(column) ? "column " + column : column));
}

void UnscaledColumn::set_unit(const StoredUnit& unit) {
  column.stored = unit.text;
  column.unit = unit.written;
  column.factor = unit.factor;
  size = unit.size;
  joint = unit.joint;
}

void UnscaledColumn::set_size(double any, std::optional<Joint> of) {
  column.stored.clear();
  column.unit = si_unit(column.kind, of.value_or(Joint::prismatic));
  column.factor = any;
  size = any;
  joint = of;
}

void UnscaledColumn::reason(std::string text) { column.reasons.push_back(std::move(text)); }

void UnscaledColumn::guess(std::string text) {
  reason(std::move(text));
  column.guessed = true;
}

UnscaledColumn* ColumnSet::find(Kind kind, bool is_setpoint) {
  const auto at = columns_.find({kind, is_setpoint});
  return at == columns_.end() ? nullptr : &at->second;
}

}  // namespace axisfit
