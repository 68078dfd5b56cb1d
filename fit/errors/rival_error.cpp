#include "fit/errors/rival_error.h"

#include <algorithm>
#include <cmath>

#include "fit/errors/scatter.h"

namespace axisfit {

std::vector<std::optional<RivalShift>> rival_errors(const Job& job,
                                                    std::span<const ParameterResult> parameters,
                                                    std::span<const RivalModels> rivals,
                                                    const ErrorOptions& options) {
  std::vector<std::optional<RivalShift>> shifts(parameters.size());
  for (RivalModels pair : rivals)
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const ParameterResult& p = parameters[i];
      if (!is_of_machine(job, i) || std::ranges::find(pair.own, p.id) != pair.own.end()) continue;
      const ParameterUncertainty alone =
          combined(without_rival(p.budget), p.value, job.free[i], options);
      if (!alone.determined) continue;
      const std::size_t quantity = job.free[i].quantity;
      const double move =
          *members(pair.with_rival)[quantity] - *members(pair.with_chosen)[quantity];
      if (std::abs(move) > options.rival_errors * alone.standard_error &&
          (!shifts[i] || std::abs(move) > std::abs(shifts[i]->value - p.value)))
        shifts[i] = RivalShift{pair.chosen, pair.rival, p.value + move};
    }
  return shifts;
}

}  // namespace axisfit
