#include "fit/search/resonances.h"

#include <algorithm>
#include <cmath>

#include "fit/judge/spectrum.h"

namespace axisfit {

std::vector<double> resonances_in(std::span<const double> residuals, double interval,
                                  std::size_t most) {
  constexpr double kCycles = 4.0, kPart = 0.33, kApart = 1.1;
  const Spectrum spectrum = periodogram(residuals, interval);
  const std::vector<double>&wave = spectrum.wave, &size = spectrum.size;
  const double least = kCycles / (interval * static_cast<double>(residuals.size())),
               largest = kPart / interval;
  std::vector<std::size_t> peaks;
  for (std::size_t k = 1; k + 1 < wave.size(); ++k)
    if (wave[k] >= least && wave[k] <= largest && size[k] >= size[k - 1] && size[k] > size[k + 1])
      peaks.push_back(k);
  std::ranges::stable_sort(peaks, std::greater{}, [&](std::size_t k) { return size[k]; });
  std::vector<double> found;
  for (const std::size_t k : peaks) {
    if (found.size() == most) break;
    const auto is_near = [&](double f) {
      return std::max(f, wave[k]) < kApart * std::min(f, wave[k]);
    };
    if (std::ranges::none_of(found, is_near)) found.push_back(wave[k]);
  }
  return found;
}

}  // namespace axisfit
