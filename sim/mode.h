// The discrete modes of the axis. Within one mode the paper's equations are linear.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

namespace axisfit {

struct Mode {
  std::int8_t contact = 0;  ///< -1, 0, +1: teeth apart, or touching on the side of that sign, (5)
  std::int8_t v_c = 0;      ///< -1, 0, +1: preamplifier free, or at the limit of that sign, (2)
  std::int8_t v_m = 0;      ///< -1, 0, +1: motor voltage free, or at the limit of that sign, (3)
  std::int8_t sliding = 0;  ///< 0: the arm sticks; -1, +1: the sign of its velocity. Meaningless
                            ///< (and 1) for an arm without dry friction.
  std::int8_t load = 1;     ///< -1, +1: the sign of the drive's force, where friction of a rigid
                            ///< transmission is in proportion to it
  bool doublet = false;     ///< whether |y1| < w, where F_s acts, (6)

  auto operator<=>(const Mode&) const = default;
};

/// From `time` (s) on the axis is in `mode`.
struct ModeChange {
  double time = 0.0;
  Mode mode;
};

/// The most guards that one mode has: two of the contact (or one of the load), of V_c, of V_m and
/// of dry friction.
inline constexpr std::size_t kGuards = 2 + 2 + 2 + 2;

/// n as a place in an array of kGuards. Throws std::length_error beyond its end.
constexpr std::size_t guard_place(std::size_t n) {
  if (n >= kGuards) throw std::length_error("a mode has more guards than kGuards");
  return n;
}

/// The surfaces on which the mode changes. A guard is positive inside the mode.
enum class Guard : std::uint8_t {
  contact_positive,     ///< x = H
  contact_negative,     ///< x = -H
  v_c_positive,         ///< V_c = V_L
  v_c_negative,         ///< V_c = -V_L
  v_m_positive,         ///< V_m = V_s
  v_m_negative,         ///< V_m = -V_s
  stop,                 ///< y1 = 0 while sliding
  doublet,              ///< |y1| = w
  load,                 ///< the drive's force passes zero
  break_away_positive,  ///< the arm's dry friction is overcome in the positive direction
  break_away_negative,  ///< and in the negative
};

}  // namespace axisfit
