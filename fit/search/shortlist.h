// The few hypotheses that are worth a refit.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "fit/search/score.h"

namespace axisfit {

struct Shortlist {
  std::vector<Scored> entries;
  std::size_t tried = 1;  ///< hypotheses and settings among which they were chosen

  std::vector<double> observer_gains{};  ///< 1/s, at which they were scored
  bool has_most = false;  ///< to first order, one of them explains most of what is missing

  /// What the score promises of a hypothesis, at its best setting and gain.
  struct Promise {
    std::shared_ptr<const Hypothesis> hypothesis;
    std::vector<double> shapes{};
    double gain = 0.0;  ///< see Scored::scaled_gain
  };
  std::vector<Promise> promises;  ///< of all that were scored, each once

  /// Adds what other gains tell.
  void add(Shortlist other, const SearchOptions& options);
  /// Nothing where it was not scored.
  std::optional<double> promised_by(const Hypothesis& hypothesis) const;
};

/// Whether a gain is most of what is beyond the noise in a sum of squares of so many samples.
bool is_most(double gain, double sum_of_squares, double samples,
             const SearchOptions::Shortlist& options);

/// The best by score_test() at each of these observer gains, from a fit with the given values of
/// the free parameters; those of the catalogue or, with `curves`, those without a name. How many:
/// SearchOptions::Shortlist. Beside other gains, here or in the list to which this one is
/// `is_added`, the free run is heard for its best. The thread pool shares the work.
Shortlist shortlist(const Job& job, const std::vector<double>& values,
                    const std::vector<double>& observer_gains, bool curves,
                    const SearchContext& context = {}, bool is_added = false);

/// Puts fits that track at this observer gain in the place of the steps of least squares: where
/// much is missing, a step tells wrongly what an effect gains, and starts its refit far away. Of
/// the entries that have had none yet, but for another transmission, which takes many steps, and
/// for what is read of the machine, in which a simulation that tracks takes part.
void fit_entries(Shortlist& list, const Job& job, const std::vector<double>& values,
                 double observer_gain, const SearchContext& context = {});

}  // namespace axisfit
