#include "bench/speed/work.h"

#include <algorithm>
#include <cmath>

namespace axisfit::speed {
namespace {

/// Root mean squares over the samples, by column.
std::vector<double> rms_of(const std::vector<double>& values, std::size_t columns) {
  std::vector<double> sums(columns, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) sums[i % columns] += values[i] * values[i];
  for (double& sum : sums)
    sum = std::sqrt(sum * static_cast<double>(columns) / static_cast<double>(values.size()));
  return sums;
}

double error_of(std::vector<double> values, const std::vector<double>& reference,
                std::size_t columns) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= reference[i];
  const std::vector<double> off = rms_of(values, columns), size = rms_of(reference, columns);
  double worst = 0.0;
  for (std::size_t c = 0; c < columns; ++c)
    if (size[c] > 0.0) worst = std::max(worst, off[c] / size[c]);
  return worst;
}

}  // namespace

Scales scales_of(const Trajectory& trajectory) {
  Scales scales{rms_of(trajectory.states, kPaperStates),
                rms_of(trajectory.sensitivities, kPaperStates * trajectory.parameters)};
  for (auto* list : {&scales.states, &scales.sensitivities})
    for (double& scale : *list)
      if (scale == 0.0) scale = 1.0;
  return scales;
}

Error error_of(const Trajectory& trajectory, const Trajectory& reference) {
  return {error_of(trajectory.states, reference.states, kPaperStates),
          error_of(trajectory.sensitivities, reference.sensitivities,
                   kPaperStates * reference.parameters)};
}

}  // namespace axisfit::speed
