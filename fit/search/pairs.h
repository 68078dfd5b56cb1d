// Two hypotheses that hide each other: each alone explains next to nothing, both together much, as
// a neighbour's inertia and a wrist that swings at the same time, or a weight and a friction on an
// axis that hardly moves. Or each explains much, and recordings that were not fitted refuse it, for
// what the other would explain is more.
//
// With Q_a and Q_b orthonormal and spanning what each does that the free parameters cannot do, and
// r the residual as in score.h, the joint score is
//
//   gain = g' [I  Q_a'Q_b; Q_b'Q_a  I]^-1 g,   g = [Q_a'r; Q_b'r],
//
// so that one Gram matrix gives those of all pairs.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fit/search/model_chain.h"
#include "fit/search/shortlist.h"

namespace axisfit {

struct ScoredPair {
  Scored first, second;    ///< where a refit with both starts; `others` are those of the job alone
  double gain = 0.0;       ///< of both, in units as Scored::scaled_gain
  bool is_hidden = false;  ///< what they gain together neither does alone
  bool is_most = false;    ///< they explain most of what is missing (Shortlist::has_most)
};

/// Those of these hypotheses that gain together more, beyond what the better of them gains alone,
/// than chance makes of the best of all pairs. First those that are hidden: they gain as much
/// beyond the sum of both. Then others, each of which may fail on what the other would explain, as
/// a friction without its offset does. Of each kind the best, and no more than
/// SearchOptions::Pairs::refitted.
std::vector<ScoredPair> score_pairs(const FittedModel& model,
                                    std::span<const double> observer_gains,
                                    std::span<const Shortlist::Promise> hypotheses,
                                    const SearchContext& context);

/// A pair that passed: refits with the first alone, and with both. The gain of each is that beside
/// the other.
struct TriedPair {
  Tried first, second;
};

/// Refits with both, and then with each. None where the pair is no better than chance, or either is
/// not needed beside the other.
std::optional<TriedPair> try_pair(const FittedModel& model, const ScoredPair& pair,
                                  const SearchContext& context);

}  // namespace axisfit
