// One round of a search: which effect, added to the present model, explains the most.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "fit/search/model_chain.h"
#include "fit/search/shortlist.h"

namespace axisfit {

/// What the rounds of a search share.
struct RoundOptions {
  bool curves = false;  ///< those without a name, instead of the catalogue's
  int shortlist = 6;    ///< effects that are refitted
  /// How probable it may be that an effect lowers the validation error by chance.
  double chance = kChance;
  bool held_out_blocks = false;       ///< no recording is to validate, see with_held_out_blocks()
  bool explained = false;             ///< what explains() says of the model
  std::vector<Candidate> excluded{};  ///< not to be tried
};

/// What a round computed of its model, for another round of the same model with other options.
/// Those of named effects and those of curves need one each.
struct RoundMemory {
  std::vector<double> of{};  ///< values and observer gain of the model
  std::optional<Shortlist> list{};
  std::vector<std::optional<ExtendedModel>> refits{};  ///< of the list's entries, not judged
  /// By the values of an extended model, see fit_elsewhere().
  std::map<std::vector<double>, std::optional<FitResult>> elsewhere{};
  /// Of the model fitted to every second stretch, see with_held_out_blocks().
  std::optional<std::vector<ResidualSeries>> on_stretches{};
};

struct RoundResult {
  std::vector<ExtendedModel> models;  ///< refitted and judged, each effect once
  std::optional<std::size_t> best{};  ///< of them; none: no effect passes
  std::size_t tried = 1;              ///< candidates and settings among which they were chosen
  /// Not refitted, since a simpler one gained as much.
  std::vector<ShortlistEntry> seconds{};
};

/// Scores all effects, refits a shortlist, and takes the best that passes the acceptance test.
/// Where the size of the residual is that of the noise, an effect may yet be hidden in it: then
/// only those are refitted whose score is beyond chance. Uses what the memory has of this model,
/// and leaves there what it computed.
RoundResult try_round(const SelectionStep& model, const RoundOptions& options, RoundMemory& memory,
                      const RunContext& context);

/// Puts an extended model, chosen among so many, to the acceptance test: against these residuals.
void judge(ExtendedModel& e, const std::vector<ResidualSeries>& before, std::size_t tried,
           double chance = kChance);

/// The model fitted to five of ten stretches of each recording: every second is left to be judged.
SelectionStep with_held_out_blocks(SelectionStep model, const RunContext& context);

}  // namespace axisfit
