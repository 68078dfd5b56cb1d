#include "fit/search/rival_models.h"

#include <algorithm>

namespace axisfit {

std::vector<RivalModels> rival_models(const EffectSelection& selection) {
  std::vector<RivalModels> models;
  for (const Substitution& pair : selection.substitutions) {
    RivalModels& found = models.emplace_back(
        RivalModels{pair.chosen, pair.rival, pair.with_chosen, pair.with_rival, {}});
    const auto chosen = std::ranges::find(selection.effects, pair.chosen,
                                          [](const Outcome& o) { return o.hypothesis.name; });
    if (chosen != selection.effects.end())
      for (const ParameterResult& p : chosen->parameters) found.own.push_back(p.id);
  }
  return models;
}

}  // namespace axisfit
