#include "init/columns/resample.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace axisfit {
namespace {

using Values = std::vector<double>;

/// What is left of a clock and its values.
struct Known {
  Values times, values;

  Known(const Values& clock, const Values& all) {
    for (std::size_t i = 0; i < std::min(clock.size(), all.size()); ++i) {
      if (std::isnan(clock[i]) || std::isnan(all[i])) continue;
      times.push_back(clock[i]);
      values.push_back(all[i]);
    }
  }
};

}  // namespace

Values held_at(const Values& times, const Values& clock, const Values& values, double offset) {
  const Known known(clock, values);
  Values result;
  if (known.values.empty()) return result;
  for (const double t : times) {
    const auto next = std::ranges::upper_bound(known.times, t - offset) - known.times.begin();
    result.push_back(known.values[static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - 1, 0))]);
  }
  return result;
}

Values interpolated_at(const Values& times, const Values& clock, const Values& values) {
  const Known known(clock, values);
  Values result;
  if (known.values.empty()) return result;
  std::size_t k = 0;
  for (const double t : times) {
    while (k < known.times.size() && known.times[k] < t) ++k;
    if (k == 0 || k == known.times.size()) {
      result.push_back(k == 0 ? known.values.front() : known.values.back());
      continue;
    }
    const double share = (t - known.times[k - 1]) / (known.times[k] - known.times[k - 1]);
    const double before = known.values[k - 1], after = known.values[k];
    result.push_back(share == 1.0 ? after : before + share * (after - before));
  }
  return result;
}

}  // namespace axisfit
