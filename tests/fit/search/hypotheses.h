// What the tests of hypotheses share.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "fit/search/catalogue.h"

namespace axisfit {

inline SearchScales scales() {
  SearchScales s;
  s.position_low = -0.1;
  s.position_high = 0.5;
  s.speed = 1.2;
  s.velocity_low = -1.2;
  s.velocity_high = 1.0;
  s.start = 0.0;
  s.end = 1.2;
  s.interval = 1e-3;
  s.periods = {0.05, 0.02};
  return s;
}

/// The hypothesis of that name; null where the list has none.
inline const Hypothesis* find(const std::vector<Hypothesis>& list, std::string_view name) {
  const auto found = std::ranges::find(list, name, &Hypothesis::name);
  return found == list.end() ? nullptr : &*found;
}

}  // namespace axisfit
