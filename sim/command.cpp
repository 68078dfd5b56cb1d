#include "sim/command.h"

namespace axisfit {

Schedule schedule_from_samples(const std::vector<double>& times,
                               const std::vector<double>& values) {
  Schedule schedule;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i > 0 && values[i] == schedule.values.back()) continue;
    schedule.append(times[i], values[i]);
  }
  return schedule;
}

}  // namespace axisfit
