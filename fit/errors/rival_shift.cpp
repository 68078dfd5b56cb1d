#include "fit/errors/rival_shift.h"

#include <algorithm>
#include <cmath>

#include "fit/errors/gain_sensitivity.h"
#include "fit/errors/scatter.h"

namespace axisfit {

void allow_for_rivals(EffectSelection& selection) {
  const Job& job = selection.result.job;
  std::vector<ParameterResult>& parameters = selection.result.fit.parameters;
  for (UndecidedPair& pair : selection.rivals) {
    const auto chosen = std::ranges::find(selection.effects, pair.chosen,
                                          [](const EffectTrial& t) { return t.candidate.name; });
    const auto is_own = [&](const ParameterResult& p) {
      return chosen != selection.effects.end() &&
             std::ranges::find(chosen->parameters, p.name, &ParameterResult::name) !=
                 chosen->parameters.end();
    };
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      ParameterResult& p = parameters[i];
      if (!is_of_machine(job, i) || !p.uncertainty.determined || is_own(p)) continue;
      const std::size_t quantity = job.free[i].quantity;
      const double move =
          *members(pair.with_rival)[quantity] - *members(pair.with_chosen)[quantity];
      if (std::abs(move) > p.uncertainty.standard_error &&
          (!p.rival_shift || std::abs(move) > std::abs(p.rival_shift->value - p.value)))
        p.rival_shift = RivalShift{pair.chosen, pair.rival, p.value + move};
    }
  }
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (ParameterResult& p = parameters[i]; p.rival_shift)
      p.uncertainty =
          widened(p.uncertainty, p.value, job.free[i], std::abs(p.rival_shift->value - p.value));
}

}  // namespace axisfit
