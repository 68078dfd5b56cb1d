// Columns whose values overflow: encoders of one turn, and signed integers stored without their
// sign.
#pragma once

#include <string_view>
#include <vector>

#include "init/column_guess.h"

namespace axisfit {

/// As the keys of a column (io/config/recording_column.h); zero: it does not.
struct Overflow {
  int signed_bits = 0;
  double wraps_after = 0.0;  ///< in the unit of the stored values

  bool any() const { return signed_bits > 0 || wraps_after > 0.0; }
  void undo(std::vector<double>& values) const;
};

/// What the stored values show of it. A position wraps where it takes up a turn (of its unit, or of
/// a power of two for whole numbers) and leaps by most of one, and by a small part at most
/// otherwise.
Overflow overflow_of(const std::vector<double>& values, Kind kind, std::string_view unit);

}  // namespace axisfit
