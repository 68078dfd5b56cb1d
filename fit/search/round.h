// One round of a search: which hypothesis, added to the present model, explains the most.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "fit/search/elsewhere.h"
#include "fit/search/model_chain.h"
#include "fit/search/pairs.h"
#include "fit/search/shortlist.h"

namespace axisfit {

/// What a round is to do.
struct RoundOptions {
  bool curves = false;  ///< those without a name, instead of the catalogue's
  bool pairs = false;   ///< two at once, too, where only that explains most of what is missing
  /// How probable it may be that an effect lowers the validation error by chance.
  double chance = SearchOptions::Acceptance().chance;
  bool elsewhere = true;               ///< what fails the test is asked of other data, too
  bool explained = false;              ///< what explains() says of the model
  std::vector<Hypothesis> excluded{};  ///< not to be tried
};

/// What a round computed of its model, for another round of the same model with other options.
/// Those of named effects and those of curves need one each.
struct RoundMemory {
  std::vector<double> of{};  ///< values and observer gain of the model
  std::optional<Shortlist> list{};
  bool is_compared = false;                    ///< the list, by fits where scores tell little
  bool is_whole = false;                       ///< the list, scored at all gains
  std::vector<std::optional<Tried>> refits{};  ///< of the list's entries, not judged
  ElsewhereMemory elsewhere{};
  bool has_no_large_pair = false;  ///< no two plain laws that explain most pass
  bool has_no_pair = false;        ///< no two hypotheses that hide each other (pairs.h) pass
};

struct RoundResult {
  /// Two plain laws that explain most of what is missing where none does alone: then none was tried
  /// alone.
  std::optional<TriedPair> pair{};
  std::vector<Tried> models;          ///< refitted and judged, each hypothesis once
  std::optional<std::size_t> best{};  ///< of them; none: none passes
  std::size_t tried = 1;              ///< hypotheses and settings among which they were chosen
  /// Not refitted: the best leaves nothing but noise, or a simpler one promised as much.
  std::vector<Scored> unrefitted{};
};

/// Scores all hypotheses, refits a shortlist, and takes the best that passes the acceptance test.
/// Where the size of the residual is that of the noise, an effect may yet be hidden in it: then
/// only those are refitted whose score is beyond chance. Uses what the memory has of this model,
/// and leaves there what it computed.
RoundResult try_round(const FittedModel& model, const RoundOptions& options, RoundMemory& memory,
                      const SearchContext& context);

}  // namespace axisfit
