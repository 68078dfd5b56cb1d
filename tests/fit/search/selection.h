// What the tests of closing the loop share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>
#include <string>

#include "fit/search/select_effects.h"
#include "tests/fit/search/hidden_effects.h"

namespace axisfit {

inline std::set<std::string> names(const EffectSelection& selection, Decision decision) {
  std::set<std::string> list;
  for (const Outcome& trial : selection.effects)
    if (trial.decision() == decision) list.insert(trial.hypothesis.name);
  return list;
}
inline std::set<std::string> accepted(const EffectSelection& selection) {
  return names(selection, Decision::accepted);
}
inline std::set<std::string> undecided(const EffectSelection& selection) {
  return names(selection, Decision::undecided);
}

/// Its last trial; null where it had none.
inline const Outcome* trial_of(const EffectSelection& selection, std::string_view name) {
  const auto found = std::ranges::find(selection.effects, name, [](const Outcome& t) {
    return std::string_view(t.hypothesis.name);
  });
  return found == selection.effects.end() ? nullptr : &*found;
}

/// Fits, closes the loop, and tells the outcome on the way.
inline EffectSelection close(const Job& job) {
  const FitResult fit = estimate(job);
  EXPECT_TRUE(fit.is_usable()) << fit.message;
  EffectSelection selection = select_effects(job, fit);
  std::cout << "reduced chi-square " << fit.reduced_chi_square << "\n";
  for (const Outcome& t : selection.effects)
    std::cout << "  " << t.hypothesis.name << ": decision " << static_cast<int>(t.decision())
              << ", reason " << static_cast<int>(t.reason) << " " << t.other
              << (t.rejection
                      ? ", failed test " + std::to_string(static_cast<int>(t.rejection->test))
                      : "")
              << "\n";
  return selection;
}

/// Expects a parameter of the result within three standard errors of the truth, and these small.
inline void expect_found(const EffectSelection& selection, const std::string& name, double truth) {
  const auto& list = selection.result.fit.parameters;
  const auto found = std::ranges::find(list, id_of(name), &ParameterResult::id);
  ASSERT_NE(found, list.end()) << name;
  const double error = found->uncertainty.standard_error;
  std::cout << "  " << name << " = " << found->value << " +- " << error << "\n";
  EXPECT_TRUE(found->uncertainty.determined) << name;
  EXPECT_NEAR(found->value, truth, 3.0 * error) << name;
  EXPECT_NEAR(found->value, truth, 0.05 * std::abs(truth)) << name;
}

inline HiddenEffect hidden_effect_named(std::string_view name) {
  const auto list = hidden_effects();
  return *std::ranges::find(list, name, &HiddenEffect::name);
}

}  // namespace axisfit
