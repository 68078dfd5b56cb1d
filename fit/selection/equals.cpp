#include "fit/selection/equals.h"

#include <algorithm>
#include <cmath>

#include "fit/estimation/gain_sensitivity.h"
#include "fit/estimation/scatter.h"

namespace axisfit {
namespace {

bool belongs_to(const Candidate& effect, std::size_t quantity) {
  const auto has = [&](const std::vector<std::size_t>& list) {
    return std::ranges::find(list, quantity) != list.end();
  };
  return has(effect.strengths) || has(effect.shapes);
}

}  // namespace

void allow_for_equals(EffectSelection& selection) {
  const Job& job = selection.result.job;
  std::vector<ParameterResult>& parameters = selection.result.fit.parameters;
  for (UndecidedPair& pair : selection.rivals) {
    const auto chosen = std::ranges::find(selection.effects, pair.chosen,
                                          [](const EffectTrial& t) { return t.candidate.name; });
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const std::size_t quantity = job.free[i].quantity;
      ParameterResult& p = parameters[i];
      if (!is_of_machine(job, i) || !p.uncertainty.determined ||
          (chosen != selection.effects.end() && belongs_to(chosen->candidate, quantity)))
        continue;
      const double move =
          *members(pair.with_rival)[quantity] - *members(pair.with_chosen)[quantity];
      if (std::abs(move) > p.uncertainty.standard_error &&
          (!p.equal_shift || std::abs(move) > std::abs(p.equal_shift->value - p.value)))
        p.equal_shift = EqualShift{pair.chosen, pair.rival, p.value + move};
    }
  }
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (ParameterResult& p = parameters[i]; p.equal_shift)
      p.uncertainty =
          widened(p.uncertainty, p.value, job.free[i], std::abs(p.equal_shift->value - p.value));
}

}  // namespace axisfit
