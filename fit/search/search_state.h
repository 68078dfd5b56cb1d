// Where a search for effects stands.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "fit/search/model_chain.h"
#include "fit/search/outcomes.h"

namespace axisfit {

/// The models of a search, and what became of the hypotheses it tried. A value that may be put
/// aside and taken up again.
struct SearchState {
  ModelChain chain;
  Outcomes outcomes{};
  std::vector<Hypothesis> degenerate{};  ///< became simpler ones, and are not tried again
  bool interrupted = false;              ///< the search was stopped here

  const FittedModel& current() const { return chain.current(); }
  const std::vector<Accepted>& accepted() const { return chain.accepted(); }
  bool explained() { return chain.explained(); }

  /// Begins anew with a declared model.
  void restart(FittedModel declared);
  /// Strikes an accepted effect off, for what its outcome says already, and what is part of it. The
  /// models are as before, until ModelChain::set_last().
  void strike_off(std::size_t place);
  /// Takes it out of the models; that without it is given.
  void take_out(std::size_t place, FittedModel reduced);
  /// Puts another in its place, with the model that has it; it goes last, where its parameters are.
  void exchange(std::size_t place, Tried other, int round);
  /// Calls an accepted effect by another hypothesis, of the same law, with the model that has it;
  /// it goes last.
  void rename(std::size_t place, const Hypothesis& other, FittedModel renamed);
  /// Takes out all that was accepted.
  void take_out_all(const Rejection& rejection);

  void report_progress(const RunContext& context, const std::string& phase,
                       Work work = Work::substitutes) const;
};

}  // namespace axisfit
