// The error of estimates by the choice between an effect and its rivals.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fit/errors/parameter_result.h"

namespace axisfit {

/// The model with an effect, and with another in its place that explains the recordings as well.
struct RivalModels {
  std::string chosen, rival;              ///< the effects
  Model<double> with_chosen, with_rival;  ///< fitted
  std::vector<ParameterId> own;           ///< parameters of the chosen effect
};

/// For every parameter of a job's fit, the furthest move with a rival in the place of the chosen
/// effect, if it is more than the standard error from the rest of the budget; none for parameters
/// that are the effect's own, not of the machine or not determined.
std::vector<std::optional<RivalShift>> rival_errors(const Job& job,
                                                    std::span<const ParameterResult> parameters,
                                                    std::span<const RivalModels> rivals,
                                                    const ErrorOptions& options = {});

}  // namespace axisfit
