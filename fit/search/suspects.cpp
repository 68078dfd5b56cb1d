#include "fit/search/suspects.h"

#include <algorithm>

#include "fit/criterion/gains.h"
#include "fit/search/score.h"

namespace axisfit {

std::vector<Scored> suspected_effects(const Job& job, const FitResult& fit,
                                      const SearchContext& context) {
  const SearchOptions::Scoring& options = context.options.scoring;
  std::vector<Scored> suspects;
  for (Scored& score :
       score_test(job, values_of(fit), score_gains(job).front(), false, context).scores) {
    if (suspects.size() == options.suspects || !(score.fraction >= options.least_fraction)) break;
    const bool known = std::ranges::any_of(
        suspects, [&](const Scored& s) { return is_same(*s.hypothesis, *score.hypothesis); });
    if (!known) suspects.push_back(std::move(score));
  }
  return suspects;
}

const Scored* likely_cause(const std::vector<Scored>& suspects,
                           const SearchOptions::Scoring& options) {
  if (suspects.empty() || !(suspects.front().fraction >= options.cause_fraction)) return nullptr;
  return &suspects.front();
}

}  // namespace axisfit
