// Where a search for effects stands.
#pragma once

#include <cstddef>
#include <string>

#include "fit/search/model_chain.h"
#include "fit/search/trials.h"

namespace axisfit {

/// The models of a search, and what became of the effects it tried. A value that may be put aside
/// and taken up again.
struct SearchState {
  ModelChain chain;
  Trials trials{};

  const SelectionStep& current() const { return chain.current(); }
  const std::vector<AcceptedEffect>& accepted() const { return chain.accepted(); }

  /// Strikes an accepted effect off, for what its trial says already, and what is part of it. The
  /// models are as before, until ModelChain::set_last().
  void strike_off(std::size_t place);
  /// Takes it out of the models; that without it is given.
  void take_out(std::size_t place, SelectionStep reduced);
  /// Takes out all that was accepted.
  void take_out_all(const Rejection& rejection);

  void report_progress(const RunContext& context, const std::string& phase) const;
};

}  // namespace axisfit
