#include "fit/data/jump_check.h"

#include <algorithm>
#include <cmath>

#include "fit/data/noise.h"

namespace axisfit {
namespace {

/// Intervals on either side by which the speed is known.
constexpr std::size_t kBeside = 3;

/// What the position does between two samples.
struct Step {
  std::size_t at = 0;   ///< the sample behind it
  double excess = 0.0;  ///< over what the speed tells
  double turn = 0.0;    ///< by which that changes from before to behind
};

Step step_at(const std::vector<double>& times, const std::vector<double>& values, std::size_t at) {
  const auto rate = [&](std::size_t from, std::size_t to) {
    return (values[to] - values[from]) / (times[to] - times[from]);
  };
  const double before = rate(at - 1 - kBeside, at - 1), behind = rate(at, at + kBeside);
  const double interval = times[at] - times[at - 1];
  return {at, values[at] - values[at - 1] - 0.5 * (before + behind) * interval,
          (behind - before) * interval};
}

}  // namespace

std::optional<Jump> jump_of(const Recording& recording, const Measurement& position,
                            const std::vector<double>& command) {
  constexpr std::size_t kLeast = 100, kJumps = 2;
  constexpr double kTimes = 5.0;   // what is usual elsewhere
  constexpr double kSteady = 4.0;  // times the change of the speed
  constexpr double kSteps = 8.0;   // of the resolution
  constexpr double kSwitch = 0.1;  // of the command's range
  const std::vector<double>&times = recording.times, &values = position.values;
  if (values.size() < kLeast) return std::nullopt;
  // The largest ones, none within the neighbourhood of another.
  std::vector<Step> apart;
  while (apart.size() <= kJumps) {
    Step largest;
    for (std::size_t at = kBeside + 1; at + kBeside < values.size(); ++at) {
      const bool is_near = std::ranges::any_of(apart, [&](const Step& other) {
        return std::max(at, other.at) - std::min(at, other.at) <= 2 * kBeside;
      });
      if (is_near) continue;
      const Step step = step_at(times, values, at);
      if (std::abs(step.excess) > std::abs(largest.excess)) largest = step;
    }
    apart.push_back(largest);
  }
  const double usual =
      std::max(std::abs(apart.back().excess), kSteps / kTimes * resolution_of(values));
  const auto [low, high] = std::ranges::minmax(command);
  const double change = kSwitch * (high - low);  // of the command, that may move the axis at once
  const auto is_jump = [&](const Step& s) {
    for (std::size_t i = s.at - kBeside; i < s.at; ++i)
      if (std::abs(command[i] - command[i - 1]) > change) return false;
    for (std::size_t i = s.at - 1 - kBeside; i <= s.at + kBeside; ++i)
      if (!position.counts(i)) return false;
    return usual > 0.0 && std::abs(s.excess) > kTimes * usual &&
           std::abs(s.excess) > kSteady * std::abs(s.turn);
  };
  const auto found = std::find_if(apart.begin(), apart.end() - 1, is_jump);
  if (found == apart.end() - 1) return std::nullopt;
  return Jump{found->at, found->excess};
}

}  // namespace axisfit
