#include "fit/data/stuck_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "fit/data/noise.h"
#include "fit/data/recording_check.h"

namespace axisfit {
namespace {

/// Least samples in a run, or at a limit, that are worth a word.
constexpr std::size_t kMinRun = 25;

/// Median of the magnitudes of some values; zero for none.
double median_magnitude(std::vector<double> values) {
  if (values.empty()) return 0.0;
  for (double& x : values) x = std::abs(x);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Fourth differences of the samples [from, to) that do not touch the value: what is left of a
/// smooth motion is little, and no step of it comes into them.
void append_differences(std::span<const double> values, std::size_t from, std::size_t to,
                        double value, std::vector<double>& differences) {
  for (std::size_t i = from; i + 5 <= to; ++i) {
    const auto part = values.subspan(i, 5);
    if (std::ranges::find(part, value) != part.end()) continue;
    differences.push_back(part[0] - 4.0 * part[1] + 6.0 * part[2] - 4.0 * part[3] + part[4]);
  }
}

/// Standard deviation of the noise that has these fourth differences.
double noise_of(std::vector<double> differences) {
  constexpr double kMedian = 0.6745, kGain = 70.0;
  return median_magnitude(std::move(differences)) / (kMedian * std::sqrt(kGain));
}

/// All maximal runs of equal values.
std::vector<EqualValues> runs_of(std::span<const double> values) {
  std::vector<EqualValues> runs;
  for (std::size_t from = 0; from < values.size();) {
    std::size_t to = from + 1;
    while (to < values.size() && values[to] == values[from]) ++to;
    runs.push_back({from, to});
    from = to;
  }
  return runs;
}

}  // namespace

/// A signal and what its values look like.
struct StuckCheck::Values {
  Signal signal = Signal::velocity;
  std::span<const double> list{};
  double range = 0.0;             ///< from the lowest to the highest
  double resolution = 0.0;        ///< as resolution_of()
  bool is_rate = false;           ///< of the position
  std::optional<double> ratio{};  ///< to the rate of the recorded position, where that is known
  double rounding = 0.0;          ///< by which that is wrong for as long as the value stays

  double at(const EqualValues& run) const { return list[run.from]; }

  /// The run with its parts at standstill.
  EqualValues whole(EqualValues run) const {
    while (run.from > 0 && list[run.from - 1] == at(run)) --run.from;
    while (run.to < list.size() && list[run.to] == at(run)) ++run.to;
    return run;
  }

  /// Fourth differences of the samples just before and behind a run.
  void append_beside(const EqualValues& run, std::vector<double>& differences) const {
    append_differences(list, run.from - std::min(run.from, kMinRun), run.from, at(run),
                       differences);
    append_differences(list, run.to, std::min(list.size(), run.to + kMinRun), at(run), differences);
  }

  /// Whether noise with these fourth differences changes the value from sample to sample. Without
  /// steps it is anything but the last digits.
  bool is_lively(std::vector<double> differences) const {
    // Rounding alone looks like noise of at most 0.35 steps, and a rate that was computed from a
    // rounded position like 0.55; more by the scatter of a median of so few.
    const double steps = (is_rate ? 0.6 : 0.42) *
                         (1.0 + 2.0 / std::sqrt(static_cast<double>(differences.size() + 1)));
    return noise_of(std::move(differences)) >
           (resolution > 0.0 ? steps * resolution : 1e-5 * range);
  }

  /// Whether the value comes to a run, and goes on behind it, by steps like those beside it: a
  /// sensor that hung comes back with all that it missed at once.
  bool is_smooth(const EqualValues& run) const {
    constexpr std::size_t kBeside = 6;
    constexpr double kAboveUsual = 3.0;
    const auto steps = [&](std::size_t from, std::size_t to) {
      double largest = 0.5 * resolution;
      for (std::size_t i = from; i + 1 < to; ++i)
        largest = std::max(largest, std::abs(list[i + 1] - list[i]));
      return largest;
    };
    const double value = at(run);
    if (run.from > 0 && std::abs(value - list[run.from - 1]) >
                            kAboveUsual * steps(run.from - std::min(run.from, kBeside), run.from))
      return false;
    return run.to >= list.size() ||
           std::abs(list[run.to] - value) <=
               kAboveUsual * steps(run.to, std::min(list.size(), run.to + kBeside));
  }
};

StuckCheck::StuckCheck(const Recording& recording, const std::vector<bool>& standstill)
    : recording_(recording),
      standstill_(standstill),
      position_(recording.find(Signal::position)),
      velocity_(recording.find(Signal::velocity)),
      command_(sampled_command(recording)) {
  // One step of an encoder that stands between two, and what noise does in a window; see
  // at_standstill().
  if (position_ != nullptr)
    position_step_ = std::max(1.5 * resolution_of(position_->values), 8.0 * position_->sigma);
  if (velocity_ != nullptr)
    velocity_limit_ = std::max(1.5 * resolution_of(velocity_->values), 4.0 * velocity_->sigma);
  command_step_ = 6.0 * noise_of_input(command_);
  const auto [low, high] = std::ranges::minmax(command_);
  command_range_ = high - low;
}

StuckCheck::Values StuckCheck::values_of(const Measurement& measurement) const {
  Values values;
  values.signal = measurement.signal;
  values.list = std::span<const double>(measurement.values.data(), measurement.values.size());
  const auto [low, high] = std::ranges::minmax(values.list);
  values.range = high - low;
  values.resolution = resolution_of(values.list);
  values.is_rate =
      measurement.signal == Signal::velocity || measurement.signal == Signal::tachometer;
  if (!values.is_rate || position_ == nullptr) return values;
  const auto found = rate_ratio(recording_.times, position_->values, values.list);
  if (!found || !found->related()) return values;
  values.ratio = found->ratio;
  // Noise makes the ratio wrong, and the right one is known.
  if (measurement.signal == Signal::velocity &&
      std::abs(std::log(std::abs(found->ratio))) < kSameUnit)
    values.ratio = std::copysign(1.0, found->ratio);
  values.rounding = values.resolution / std::abs(*values.ratio);
  // Of differences of the position itself the errors do not add up.
  const double one_step = resolution_of(position_->values) / sampling(recording_.times).interval;
  if (std::abs(values.rounding - one_step) < 0.05 * one_step) values.rounding = 0.0;
  return values;
}

/// Whether the arm does not move measurably during a run.
bool StuckCheck::rests(const Values& values, const EqualValues& run) const {
  if (position_ != nullptr) {
    const auto [low, high] =
        std::ranges::minmax(std::span(position_->values.data(), position_->values.size())
                                .subspan(run.from, run.size()));
    return high - low <= position_step_;
  }
  if (velocity_ == nullptr || values.signal == Signal::velocity) return false;
  for (std::size_t i = run.from; i < run.to; ++i)
    if (std::abs(velocity_->values[i]) > velocity_limit_) return false;
  return true;
}

/// Whether the command begins to stay, and changes again, where the signal does.
bool StuckCheck::is_commanded(const EqualValues& run) const {
  constexpr std::size_t kLate = 2;
  const auto changes_about = [&](std::size_t sample) {
    for (std::size_t i = sample > kLate ? sample - kLate : 1;
         i <= std::min(sample + 1, command_.size() - 1); ++i)
      if (std::abs(command_[i] - command_[i - 1]) > command_step_) return true;
    return sample == 0 || sample == command_.size();
  };
  for (std::size_t i = run.from + 1; i + kLate < run.to; ++i)
    if (std::abs(command_[i] - command_[i - 1]) > command_step_) return false;
  return changes_about(run.from) && changes_about(run.to);
}

/// Whether a speed stays although what drives the axis changes much. A coarse speed may do so at a
/// reversal of the acceleration, any may about a jump of the command, and a reference does not
/// drive the axis.
bool StuckCheck::is_pushed(const Values& values, const EqualValues& run) const {
  constexpr double kMuch = 1.0 / 3.0, kLeastSteps = 100.0;
  if (!values.is_rate || values.at(run) == 0.0 ||
      recording_.command.meaning == Meaning::reference || run.size() < 4 ||
      values.range < kLeastSteps * values.resolution)
    return false;
  const auto [low, high] =
      std::ranges::minmax(std::span(command_).subspan(run.from + run.size() / 4, run.size() / 2));
  return high - low > kMuch * command_range_;
}

/// Whether the position moves during a run as fast as the rate says, as far as can be told.
bool StuckCheck::agrees_with_position(const Values& values, const EqualValues& run) const {
  constexpr double kGainError = 0.03, kLateSamples = 2.0;
  const double rate = values.at(run) / *values.ratio;
  const double late = kLateSamples * (recording_.times[run.from + 1] - recording_.times[run.from]);
  for (std::size_t i = run.from + 1; i < run.to; ++i) {
    const double time = recording_.times[i] - recording_.times[run.from];
    const double moved = position_->values[i] - position_->values[run.from];
    const double error =
        position_step_ + values.rounding * time + std::abs(rate) * (kGainError * time + late);
    if (std::abs(moved - rate * time) > error) return false;
  }
  return true;
}

/// Whether anything but its sensor explains that a signal stays.
bool StuckCheck::is_explained(const Values& values, const EqualValues& run) const {
  std::vector<double> beside;
  values.append_beside(run, beside);
  const bool is_lively = values.is_lively(std::move(beside));
  if (!is_lively && is_commanded(values.whole(run))) return true;
  // Many instruments show no noise where nothing moves.
  const bool at_zero = values.is_rate && values.at(run) == 0.0;
  if (values.ratio) return agrees_with_position(values, run) && (at_zero || !is_lively);
  if (is_pushed(values, run)) return false;
  return rests(values, run) || ((at_zero || !is_lively) && values.is_smooth(run));
}

EqualValues StuckCheck::stuck(const Measurement& measurement) const {
  const Values values = values_of(measurement);
  EqualValues longest;
  std::size_t pairs = 0, equal = 0;
  const auto count = [&](const EqualValues& run) {
    equal += run.size() - 1;
    pairs += run.size() - 1;
  };
  for (const EqualValues& whole : runs_of(values.list)) {
    // Without its parts at standstill.
    for (std::size_t from = whole.from; from < whole.to;) {
      std::size_t to = from + 1;
      while (to < whole.to && is_moving(to) == is_moving(from)) ++to;
      const EqualValues run{from, to};
      from = to;
      if (!is_moving(run.from)) continue;
      ++pairs;
      if (run.size() < kMinRun) {
        count(run);
      } else if (!is_explained(values, run) && run.size() > longest.size()) {
        if (longest.size() > 0) count(longest);
        longest = run;
      }
    }
  }
  if (longest.size() == 0) return {};
  // Outside of the run: so often a value is followed by its equal, for example on a coarse grid.
  const double usual = static_cast<double>(equal + 1) / static_cast<double>(pairs + 2);
  const bool is_chance = static_cast<double>(longest.size()) * std::log(usual) >
                         std::log(1e-9 / static_cast<double>(values.list.size()));
  return is_chance ? EqualValues() : longest;
}

/// How many samples at an end of the range, of which `other` is the other end, nothing explains but
/// that the sensor ends there.
std::size_t StuckCheck::clipped_at(const Values& values, double limit, double other) const {
  std::size_t there = 0, commanded = 0, next = 0, contradicted = 0, equal = 0, pairs = 0;
  std::vector<double> beside;
  for (const EqualValues& run : runs_of(values.list)) {
    if (!is_moving(run.from)) continue;
    const double distance = std::abs(values.at(run) - limit);
    if (distance > 0.0) {
      if (distance < 1.5 * values.resolution) next += run.size();
      if (values.at(run) == other) continue;  // it may be clipped there, too
      equal += run.size() - 1;
      pairs += run.size();
      continue;
    }
    if (run.size() > 1 &&
        (values.ratio ? !agrees_with_position(values, run) : is_pushed(values, run)))
      contradicted += run.size();
    if (rests(values, run)) continue;
    there += run.size();
    if (is_commanded(run)) commanded += run.size();
    values.append_beside(run, beside);
  }
  if (contradicted >= kMinRun) return contradicted;
  if (!values.is_lively(std::move(beside))) {
    if (values.resolution > 0.0) return 0;  // it may well stay
    there -= commanded;
  }
  // Zero is where signals rest and not where ranges end.
  if (limit == 0.0 || there < kMinRun) return 0;
  if (values.resolution == 0.0) {
    constexpr double kRarely = 0.1;  // values that are set one by one stay elsewhere, too
    return static_cast<double>(equal) < kRarely * static_cast<double>(pairs) ? there : 0;
  }
  // Noise leaves fewer samples at its very end than beside it; what is beyond a range is all there.
  constexpr double kPiledUp = 2.0;
  return static_cast<double>(there) > kPiledUp * static_cast<double>(next) ? there : 0;
}

ClippedValues StuckCheck::clipped(const Measurement& measurement) const {
  const Values values = values_of(measurement);
  const auto [low, high] = std::ranges::minmax(measurement.values);
  ClippedValues found;
  // A constant signal stays at both.
  if (!(high > low)) return found;
  for (const auto& [limit, other] : {std::pair(low, high), std::pair(high, low)})
    if (const std::size_t samples = clipped_at(values, limit, other); samples > found.samples)
      found = {samples, limit};
  return found;
}

std::vector<double> sampled_command(const Recording& recording) {
  const Schedule& command = recording.command;
  std::vector<double> values;
  std::size_t next = 0;
  for (const double t : recording.times) {
    while (next < command.times.size() && command.times[next] <= t) ++next;
    values.push_back(next > 0 ? command.values[next - 1] : 0.0);
  }
  return values;
}

}  // namespace axisfit
