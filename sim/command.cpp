#include "sim/command.h"

#include <algorithm>

namespace axisfit {

double Schedule::value_at(double time) const {
  const auto after = std::ranges::upper_bound(times, time);
  if (after == times.begin()) return hold == Hold::linear && !values.empty() ? values[0] : 0.0;
  const auto k = static_cast<std::size_t>(after - times.begin()) - 1;
  return values[k] + slope_after(k) * (time - times[k]);
}

Schedule schedule_from_samples(const std::vector<double>& times, const std::vector<double>& values,
                               Hold hold) {
  Schedule schedule;
  schedule.hold = hold;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const bool repeats = i > 0 && values[i] == values[i - 1];
    const bool last = i + 1 == times.size();
    if (repeats && (hold == Hold::zero_order || (!last && values[i] == values[i + 1]))) continue;
    schedule.append(times[i], values[i]);
  }
  return schedule;
}

}  // namespace axisfit
