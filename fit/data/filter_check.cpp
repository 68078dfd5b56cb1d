#include "fit/data/filter_check.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include "fit/data/noise.h"

namespace axisfit {
namespace {

/// The value below which this part of the values lies; reorders them.
double quantile(std::span<double> values, double part) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

/// Correlation of normal values about zero with others that many samples before, by their signs
/// alone, so that a few large ones do not count.
double correlation_of_signs(std::span<const double> values, std::span<const double> others,
                            std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = lag; i < values.size(); ++i) {
    const double product = values[i] * others[i - lag];
    sum += double(product > 0.0) - double(product < 0.0);
  }
  return std::sin(0.5 * std::numbers::pi * sum / static_cast<double>(values.size() - lag));
}

double correlation_of_signs(std::span<const double> values, std::size_t lag) {
  return correlation_of_signs(values, values, lag);
}

/// The quieter half of a signal's sixth differences in two neighbouring octaves of its spectrum:
/// about 0.5 / stride cycles per sample, and half of that.
struct TwoOctaves {
  double high = 0.0, low = 0.0;  ///< standard deviation of the noise in them, if it is noise
  bool alternates = false;  ///< as noise does, and neither smooth motion nor a tone: the low one
  bool is_noise = false;    ///< the same, and it is distributed like noise

  TwoOctaves(std::span<const double> values, std::size_t stride) {
    const std::vector<double> highs = sixth_differences(values, stride),
                              lows = sixth_differences(values, 2 * stride);
    // Where a gear rings or a command jumps, an octave holds more than noise.
    constexpr std::size_t kBlocks = 16;
    const std::size_t size = lows.size() / kBlocks;
    std::vector<std::pair<double, std::size_t>> blocks;
    for (std::size_t from = 0; blocks.size() < kBlocks; from += size) {
      std::vector<double> block = magnitudes(std::span(lows).subspan(from, size));
      blocks.emplace_back(quantile(block, 0.5), from);
    }
    std::ranges::sort(blocks);
    std::vector<double> quiet_highs, quiet_lows;
    double correlation = 0.0;
    for (std::size_t b = 0; b < kBlocks / 2; ++b) {
      const std::span of_low = std::span(lows).subspan(blocks[b].second, size);
      correlation += 2.0 / kBlocks * correlation_of_signs(of_low, 2 * stride);
      std::ranges::copy(magnitudes(of_low), std::back_inserter(quiet_lows));
      std::ranges::copy(magnitudes(std::span(highs).subspan(blocks[b].second, size)),
                        std::back_inserter(quiet_highs));
    }
    constexpr double kMedian = 0.6745, kGain = 924.0;
    high = quantile(quiet_highs, 0.5) / (kMedian * std::sqrt(kGain));
    const double middle = quantile(quiet_lows, 0.5);
    low = middle / (kMedian * std::sqrt(kGain));
    // White noise has -0.86, noise that falls by 12 dB per octave -0.8; a smooth motion nearly 1.
    // The tail is 2.9 for normal values, 1.4 for a tone, and long for a gear that rings now and
    // then.
    const double tail = quantile(quiet_lows, 0.95) / middle;
    alternates = correlation < -0.5 && tail > 2.2;
    is_noise = alternates && tail < 4.0;
  }

 private:
  static std::vector<double> magnitudes(std::span<const double> values) {
    std::vector<double> sizes;
    for (const double x : values) sizes.push_back(std::abs(x));
    return sizes;
  }
};

/// Length of a moving average of white noise: a difference of it is that of what enters and what
/// leaves, so that differences so far apart are opposite, and their neighbours are not. A tone is
/// opposite after half a period, too, and so is what rounding makes of one; but it is back after a
/// whole period, and not only so near the half, where an average has forgotten. Zero where there is
/// none.
std::size_t moving_average_in(std::span<const double> values) {
  const std::vector<double> d = sixth_differences(values, 1);
  constexpr std::size_t kLeast = 5;                     // nearer ones overlap
  constexpr double kOpposite = -0.4, kNeighbour = 0.2;  // of -0.5, and of 0.42
  constexpr std::size_t kBeyond = 8;  // sixth differences of white noise have forgotten after six
  const std::size_t most = std::min<std::size_t>(500, d.size() / 8);
  // Three standard errors of such a correlation of neighbours that are correlated themselves.
  const double by_chance = std::max(kNeighbour, 9.0 / std::sqrt(static_cast<double>(d.size())));
  const auto none_about = [&](std::size_t from, std::size_t to) {
    for (std::size_t lag = from; lag <= to; ++lag)
      if (std::abs(correlation_of_signs(d, lag)) > by_chance) return false;
    return true;
  };
  for (std::size_t lag = kLeast; lag <= most; ++lag)
    if (correlation_of_signs(d, lag) < kOpposite && correlation_of_signs(d, lag - 1) > kNeighbour &&
        correlation_of_signs(d, lag + 1) > kNeighbour && none_about(2 * lag - 2, 2 * lag + 2) &&
        none_about(lag + kBeyond, lag + kBeyond + 1))
      return lag;
  return 0;
}

/// Whether what a signal has in the octave about 0.25 / stride cycles per sample goes along with
/// the command, however late: an axis turns the phase by up to half a period, and drives and
/// recorders are late by little.
bool follows_command(std::span<const double> values, std::span<const double> command,
                     std::size_t stride) {
  if (command.empty()) return false;
  const std::vector<double> of_values = sixth_differences(values, 2 * stride),
                            of_command = sixth_differences(command, 2 * stride);
  const std::size_t period = 4 * stride;
  // Above what is left of noise by chance, at any of the lags: an octave has about one value of
  // its own per period.
  constexpr double kAtLeast = 0.4, kByChance = 4.0;
  const double periods = static_cast<double>(of_values.size()) / static_cast<double>(period);
  const double limit = std::max(kAtLeast, kByChance / std::sqrt(periods));
  for (std::size_t lag = 0; lag <= 2 * period; lag += std::max<std::size_t>(1, stride / 2))
    if (std::abs(correlation_of_signs(of_values, of_command, lag)) > limit) return true;
  return false;
}

/// Of values, to tell a pattern, and how many of them may be none of it.
constexpr std::size_t kLeastChanges = 30;
constexpr double kAlmostAll = 0.98;

}  // namespace

bool changes_with(std::span<const double> values, std::span<const double> others) {
  std::size_t changes = 0, together = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] == values[i - 1]) continue;
    ++changes;
    together += others[i] != others[i - 1] ? 1 : 0;
  }
  return changes >= kLeastChanges &&
         static_cast<double>(together) >= kAlmostAll * static_cast<double>(changes);
}

std::size_t repetition_of(std::span<const double> values) {
  constexpr double kBeyondRounding = 1.9;
  std::vector<double> distances, changes;
  for (std::size_t i = 1, last = 0; i < values.size(); ++i) {
    if (values[i] == values[i - 1]) continue;
    if (last > 0) distances.push_back(static_cast<double>(i - last));
    changes.push_back(std::abs(values[i] - values[i - 1]));
    last = i;
  }
  if (distances.size() < kLeastChanges) return 1;
  const double usual = quantile(distances, 0.5);
  const auto multiples =
      std::ranges::count_if(distances, [&](double x) { return std::fmod(x, usual) == 0.0; });
  if (static_cast<double>(multiples) < kAlmostAll * static_cast<double>(distances.size())) return 1;
  if (quantile(changes, 0.5) < kBeyondRounding * resolution_of(values)) return 1;
  return static_cast<std::size_t>(usual);
}

std::optional<SuspectedFilter> suspected_filter(std::span<const double> values,
                                                std::span<const double> command) {
  constexpr std::size_t kLeastValues = 500;
  if (values.size() < kLeastValues) return std::nullopt;
  TwoOctaves octaves(values, 1);
  // The last digits of a number are no noise.
  const auto [lowest, highest] = std::ranges::minmax(values);
  if (!(octaves.low > 1e-9 * (highest - lowest))) return std::nullopt;
  if (octaves.alternates && octaves.low > octaves.high && !follows_command(values, command, 1))
    if (const std::size_t average = moving_average_in(values); average > 0)
      return SuspectedFilter{0.44 / static_cast<double>(average), average};
  // Rounding is white only where the noise makes it so.
  if (!(octaves.high > 0.5 * resolution_of(values))) return std::nullopt;
  // From the highest octave on: what rings in a lower one leaves the noise above it white.
  const double rise = 1.3 + 5.0 / std::sqrt(static_cast<double>(values.size()));
  // A lower one has fewer values of its own, of which some slips make anything.
  constexpr std::size_t kLowest = 8, kLeastPerStride = 250;
  std::size_t stride = 1;
  while (octaves.low > rise * octaves.high && !octaves.is_noise && stride < kLowest &&
         2 * stride * kLeastPerStride <= values.size())
    octaves = TwoOctaves(values, stride *= 2);
  if (!octaves.is_noise || !(octaves.low > rise * octaves.high)) return std::nullopt;
  if (follows_command(values, command, stride)) return std::nullopt;
  constexpr double kStillRises = 1.25;
  while (octaves.is_noise && octaves.low > kStillRises * octaves.high &&
         64 * stride < values.size())
    octaves = TwoOctaves(values, stride *= 2);
  return SuspectedFilter{0.5 / static_cast<double>(stride)};
}

}  // namespace axisfit
