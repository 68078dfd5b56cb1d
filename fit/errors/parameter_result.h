// One estimate and what is known of it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fit/errors/error_budget.h"

namespace axisfit {

/// A quantity whose value is a guess, and what becomes of an estimate when that changes.
struct GuessInfluence {
  ParameterId id;
  double elasticity = 0.0;  ///< d ln estimate / d ln guess
};

/// What becomes of an estimate when the input goes otherwise from sample to sample.
struct HoldShift {
  double value = 0.0;
  bool is_better = false;  ///< so, the recordings are explained clearly better
};

struct ParameterResult {
  ParameterId id;
  double value = 0.0;
  ParameterUncertainty uncertainty;        ///< what the budget comes to, unless the model is wrong
  ErrorBudget budget{};                    ///< sampling and input noise; the rest is found by run()
  std::vector<GuessInfluence> rests_on{};  ///< see guesses.h; found by run()
  std::optional<HoldShift> other_hold{};   ///< see hold_shift.h; found by run()
};

inline std::vector<double> values_of(std::span<const ParameterResult> parameters) {
  std::vector<double> values;
  for (const ParameterResult& p : parameters) values.push_back(p.value);
  return values;
}

}  // namespace axisfit
