// One round of a search: which effect, added to the present model, explains the most.
#pragma once

#include <cstddef>
#include <vector>

#include "fit/selection/model_chain.h"

namespace axisfit {

/// What the rounds of a search share.
struct RoundOptions {
  bool curves = false;  ///< those without a name, instead of the catalogue's
  int shortlist = 6;    ///< effects that are refitted
  /// How probable it may be that an effect lowers the validation error by chance.
  double chance = kChance;
  bool held_out_blocks = false;       ///< no recording is to validate, see with_held_out_blocks()
  std::vector<Candidate> excluded{};  ///< not to be tried
};

struct RoundResult {
  std::vector<ExtendedModel> models;  ///< refitted and judged, each effect once
  std::optional<std::size_t> best{};  ///< of them; none: no effect passes
  std::size_t tried = 1;              ///< candidates and settings among which they were chosen
};

/// Scores all effects, refits a shortlist, and takes the best that passes the acceptance test.
/// Where the size of the residual is that of the noise, an effect may yet be hidden in it: then
/// only those are refitted whose score is beyond chance.
RoundResult try_round(const SelectionStep& model, const RoundOptions& options,
                      const RunContext& context);

/// Puts an extended model, chosen among so many, to the acceptance test: against these residuals.
void judge(ExtendedModel& e, const std::vector<ResidualSeries>& before, std::size_t tried,
           double chance = kChance);

/// The model fitted to five of ten stretches of each recording: every second is left to be judged.
SelectionStep with_held_out_blocks(SelectionStep model, const RunContext& context);

}  // namespace axisfit
