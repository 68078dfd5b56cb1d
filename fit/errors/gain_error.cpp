#include "fit/errors/gain_error.h"

#include <cmath>

namespace axisfit {

std::vector<std::optional<GainShift>> gain_errors(std::span<const ParameterResult> parameters,
                                                  std::span<const EstimatesAtGain> others,
                                                  const ErrorOptions& options) {
  std::vector<std::optional<GainShift>> shifts(parameters.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ParameterResult& here = parameters[i];
    double furthest = 0.0;
    for (const EstimatesAtGain& other : others) {
      const ParameterResult& there = other.parameters[i];
      if (!here.uncertainty.determined || !there.uncertainty.determined) continue;
      const double move = std::abs(there.value - here.value);
      const double errors =
          std::hypot(here.uncertainty.standard_error, there.uncertainty.standard_error);
      if (move <= options.gain_errors * errors || move <= furthest) continue;
      furthest = move;
      shifts[i] = GainShift{other.observer_gain, there.value};
    }
  }
  return shifts;
}

}  // namespace axisfit
