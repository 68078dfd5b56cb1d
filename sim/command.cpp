#include "sim/command.h"

namespace axisfit {

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
