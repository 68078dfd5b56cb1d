// The few candidates that are worth a fit of their own.
#pragma once

#include <cstddef>
#include <vector>

#include "fit/search/score.h"

namespace axisfit {

/// A candidate, and where its fit should start.
struct ShortlistEntry {
  Candidate candidate;
  Score score;
  double gain = 0.0;     ///< the score's, in units of the residuals' mean square, at least one
  double promise = 0.0;  ///< the same in units of the acceptance test, see Improvement::fit_gain
  /// A simpler one gains as much, so that this is worth a fit only where that one fails.
  bool is_second = false;
};

struct Shortlist {
  std::vector<ShortlistEntry> entries;
  std::size_t tried = 1;  ///< candidates and settings among which they were chosen
};

/// The best by score_test() at each of these observer gains, about `length` of each, from a fit
/// with the given values of the free parameters; those of the catalogue or, with `curves`, those
/// without a name. Beyond the first three, what gains less than half as much as the best is left
/// out. The thread pool shares the work.
Shortlist shortlist(const Job& job, const std::vector<double>& values,
                    const std::vector<double>& observer_gains, bool curves, int length,
                    const RunContext& context = {});

}  // namespace axisfit
