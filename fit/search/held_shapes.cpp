#include "fit/search/held_shapes.h"

#include <algorithm>
#include <optional>
#include <set>
#include <span>
#include <utility>

namespace axisfit {
namespace {

/// The model with another setting of a shape that a law holds, such as its exponent, if one of them
/// explains the recordings better.
std::optional<FittedModel> with_better_held(const FittedModel& model, const Hypothesis& law,
                                            std::size_t shape, const SearchContext& context) {
  const std::size_t quantity = law.shapes[shape];
  if (std::ranges::find(model.job.free, quantity, &FreeParameter::quantity) != model.job.free.end())
    return std::nullopt;
  std::set<double> settings;
  for (const std::vector<double>& setting : law.settings) settings.insert(setting[shape]);
  std::optional<FittedModel> best;
  for (const double value : settings) {
    FittedModel other = model;
    double& held = *members(other.job.model)[quantity];
    if (std::exchange(held, value) == value) continue;
    other.fit = refit_from(other.job, values_of(model.fit), context);
    if (other.fit.is_usable() && loss_of(other, best ? *best : model) > 0.0)
      best = std::move(other);
  }
  return best;
}

/// The shapes that the first so many accepted laws hold, by their places among those of the law.
std::vector<std::pair<Hypothesis, std::size_t>> held_shapes(const SearchState& state,
                                                            std::size_t count) {
  std::vector<std::pair<Hypothesis, std::size_t>> held;
  for (const Accepted& accepted : std::span(state.accepted()).first(count)) {
    const Hypothesis& law = accepted.hypothesis;
    if (law.kind != HypothesisKind::effect) continue;
    for (std::size_t k = law.estimated_shapes().size(); k < law.shapes.size(); ++k)
      held.emplace_back(law, k);
  }
  return held;
}

}  // namespace

Tried* best_beside_held(Tried* best, std::vector<Tried>& models, const SearchState& state,
                        const SearchContext& context) {
  const auto held = held_shapes(state, state.accepted().size());
  std::vector<Tried*> equals;
  for (Tried& e : models)
    if (!e.rejection && !is_clearly_worse(bic_advantage(*best, e), context.options))
      equals.push_back(&e);
  if (held.empty() || equals.size() < 2 || explains({"", best->job, best->fit})) return best;
  for (Tried* e : equals)
    for (const auto& [law, shape] : held)
      if (auto better = with_better_held({"", e->job, e->fit}, law, shape, context)) {
        e->job = std::move(better->job);
        e->fit = std::move(better->fit);
        e->residuals = residual_series(e->job, e->fit);
      }
  return *std::ranges::max_element(
      equals, [](const Tried* a, const Tried* b) { return bic_advantage(*a, *b) < 0.0; });
}

void reconsider_held(SearchState& state, std::size_t count, const SearchContext& context) {
  for (const auto& [law, shape] : held_shapes(state, count)) {
    if (state.explained()) return;
    if (auto better = with_better_held(state.current(), law, shape, context))
      state.chain.set_last(*std::move(better));
  }
}

}  // namespace axisfit
