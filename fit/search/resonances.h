// Frequencies at which a residual rings.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace axisfit {

/// The frequencies (Hz) of the largest peaks in the spectrum of residuals that are `interval` s
/// apart, best first, at most `most` of them and no two within a tenth: from a few cycles in the
/// recording up to a third of the sampling rate. As fine as the whole recording can show, for a
/// resonance of little damping is narrow. None of fewer than 32 values.
std::vector<double> resonances_in(std::span<const double> residuals, double interval,
                                  std::size_t most);

}  // namespace axisfit
