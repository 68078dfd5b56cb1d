#include "fit/search/exchanged_roles.h"

#include <algorithm>
#include <set>
#include <utility>

namespace axisfit {
namespace {

/// Whether every recording has the same signals to be fitted.
bool records_alike(const std::vector<Recording>& recordings) {
  const auto signals_of = [](const Recording& r) {
    std::set<Signal> signals;
    for (const Measurement& m : r.measurements)
      if (m.fitted) signals.insert(m.signal);
    return signals;
  };
  const std::set<Signal> wanted = signals_of(recordings.front());
  return std::ranges::all_of(recordings,
                             [&](const Recording& r) { return signals_of(r) == wanted; });
}

}  // namespace

std::optional<ExchangedSearch> search_with_exchanged_roles(const Job& baseline,
                                                           const RunContext& context) {
  if (!records_alike(baseline.recordings)) return std::nullopt;
  std::optional<Job> exchanged = with_exchanged_roles(baseline);
  if (!exchanged) return std::nullopt;
  context.report({.phase = "fitting with the roles exchanged"});
  ExchangedSearch found;
  found.baseline = *std::move(exchanged);
  found.first = estimate_with_noise(found.baseline, context);
  if (found.first.interrupted) throw Interrupted();
  found.inverse_start = try_inverse_start(found.baseline, found.first, context);
  if (!found.first.is_usable()) return std::nullopt;
  SearchOptions options;
  options.far_from_noise.of_model = options.far_from_noise.of_model_exchanged;
  found.selection = select_effects(found.baseline, found.first, options, context);
  if (found.selection.interrupted) throw Interrupted();
  if (found.selection.cut_short) return found;
  if (found.selection.verdict.kind != SelectionVerdict::Kind::effects_accepted) return std::nullopt;
  return found;
}

}  // namespace axisfit
