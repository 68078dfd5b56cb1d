// A search with the roles of the recordings exchanged.
#pragma once

#include <optional>

#include "fit/judge/second_opinion.h"
#include "fit/search/select_effects.h"

namespace axisfit {

/// What such a search finds, and what it began with.
struct ExchangedSearch {
  Job baseline;
  FitResult first;
  InverseStart inverse_start = InverseStart::not_tried;
  EffectSelection selection{};
};

/// The recordings to validate may show what those to fit do not, such as friction at places that
/// these never reach. So where a search finds nothing, one more fits those to validate: again what
/// was not fitted decides. A second try finds more by chance, so more is asked for
/// (SearchOptions::FarFromNoise). None where recordings differ in their fitted signals, their roles
/// cannot be exchanged, or no effect is accepted; one that was cut short found nothing yet. Throws
/// Interrupted.
std::optional<ExchangedSearch> search_with_exchanged_roles(const Job& baseline,
                                                           const RunContext& context = {});

}  // namespace axisfit
