// Columns whose values overflow: encoders of one turn, and signed integers stored without their
// sign.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "init/columns/units.h"

namespace axisfit {

/// As the keys of a column (io/config/recording_column.h); zero: it does not.
struct Overflow {
  int signed_bits = 0;
  double wraps_after = 0.0;  ///< in the unit of the stored values

  bool any() const { return signed_bits > 0 || wraps_after > 0.0; }
  void undo(std::vector<double>& values) const;
};

/// What the stored values show of it. A position wraps where it takes up a turn and leaps by most
/// of one, and by a small part at most otherwise. `turn` is how much of the stored values that is,
/// where their unit tells it; whole numbers begin anew after a power of two, too. Where neither
/// turn nor `unit` is known, it may be one of degrees or radians.
Overflow overflow_of(const std::vector<double>& values, Kind kind, std::optional<double> turn,
                     std::string_view unit = {});

}  // namespace axisfit
