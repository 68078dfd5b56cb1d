// What other data than the fitted recordings tell of effects that lower no error beyond those.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "fit/search/model_chain.h"

namespace axisfit {

/// What was computed of a model, to be asked again.
struct ElsewhereMemory {
  /// By the values of the extended model, see fit_elsewhere().
  std::map<std::vector<double>, std::optional<FitResult>> fits{};
  /// The residuals of the model fitted to every second block, see with_held_out_blocks().
  std::optional<std::vector<ResidualSeries>> on_blocks{};
};

/// Of refits beside the model that were rejected because the recordings to validate do not show
/// them: accepts those that these show as well where they are fitted by themselves, and where they
/// could not show them, those that held-out blocks of the fitted recordings do. In the order of
/// their gains, down to what explains clearly less than one that is confirmed; where the fitted
/// recordings hold nothing but noise, only the first few. `strictness`: how they were chosen.
void ask_elsewhere(const FittedModel& model, std::vector<Tried>& refits,
                   const Strictness& strictness, ElsewhereMemory& memory,
                   const SearchContext& context);

/// The model fitted to every second of some blocks of each recording: the others are left to be
/// judged.
FittedModel with_held_out_blocks(FittedModel model, const SearchContext& context);

}  // namespace axisfit
