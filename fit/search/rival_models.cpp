#include "fit/search/rival_models.h"

namespace axisfit {

std::vector<RivalModels> rival_models(const EffectSelection& selection) {
  std::vector<RivalModels> models;
  for (const Substitution& pair : selection.substitutions) {
    RivalModels& found = models.emplace_back(
        RivalModels{pair.chosen, pair.rival, pair.with_chosen, pair.with_rival, {}});
    // An effect may have been tried in several forms, and go with parts of it.
    for (const Outcome& o : selection.effects)
      if (o.hypothesis.name == pair.chosen || o.hypothesis.extends == pair.chosen)
        for (const ParameterResult& p : o.parameters) found.own.push_back(p.id);
  }
  return models;
}

}  // namespace axisfit
