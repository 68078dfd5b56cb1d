#include "init/overflow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/recording/counters.h"

namespace axisfit {
namespace {

using Values = std::vector<double>;

Values there(const Values& values) {
  Values kept;
  std::ranges::copy_if(values, std::back_inserter(kept), [](double x) { return !std::isnan(x); });
  return kept;
}

double largest_step(const Values& values) {
  double most = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i)
    most = std::max(most, std::abs(values[i] - values[i - 1]));
  return most;
}

bool are_whole(const Values& values) {
  return std::ranges::all_of(values, [](double x) { return x == std::round(x); });
}

/// Small values of both signs lie at both ends of the range, and none between.
int signed_bits_of(const Values& values) {
  if (!are_whole(values) || std::ranges::min(values) < 0.0) return 0;
  const double most = std::ranges::max(values);
  for (const int bits : {16, 32}) {
    const double all = std::ldexp(1.0, bits);
    if (most < 0.75 * all || most >= all) continue;
    const bool is_empty =
        std::ranges::none_of(values, [&](double x) { return x > 0.25 * all && x < 0.75 * all; });
    if (is_empty && std::ranges::min(values) < 0.25 * all) return bits;
  }
  return 0;
}

Values turns_of(std::optional<double> turn, std::string_view unit, const Values& values) {
  Values turns;
  if (turn) turns.push_back(*turn);
  const bool is_open = !turn && (unit.empty() || is_raw(unit));
  if (is_open) turns.insert(turns.end(), {2.0 * std::numbers::pi, 360.0});
  if (!are_whole(values)) return turns;
  if (is_open) turns.insert(turns.end(), {3600.0, 36000.0, 360000.0});
  for (int bits = 8; bits <= 32; ++bits) turns.push_back(std::ldexp(1.0, bits));
  return turns;
}

double wraps_after(const Values& values, std::optional<double> known, std::string_view unit) {
  const auto [least, most] = std::ranges::minmax(values);
  const double range = most - least, step = largest_step(values);
  for (const double turn : turns_of(known, unit, values)) {
    constexpr double kRounding = 1e-6;
    if (range > turn * (1.0 + kRounding) || range < 0.9 * turn || step < 0.5 * turn) continue;
    Values continuous = values;
    unwrap(continuous, turn);
    if (largest_step(continuous) < 0.25 * turn) return turn;
  }
  return 0.0;
}

}  // namespace

void Overflow::undo(Values& values) const {
  if (signed_bits > 0) restore_sign(values, signed_bits);
  if (wraps_after > 0.0) unwrap(values, wraps_after);
}

Overflow overflow_of(const Values& values, Kind kind, std::optional<double> turn,
                     std::string_view unit) {
  Overflow overflow;
  const Values known = there(values);
  if (known.size() < 2 || kind == Kind::time) return overflow;
  overflow.signed_bits = signed_bits_of(known);
  const bool is_place = kind == Kind::position || kind == Kind::load_position;
  if (overflow.signed_bits == 0 && is_place) overflow.wraps_after = wraps_after(known, turn, unit);
  return overflow;
}

}  // namespace axisfit
