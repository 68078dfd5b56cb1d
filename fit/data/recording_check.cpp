#include "fit/data/recording_check.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "fit/data/jump_check.h"
#include "fit/data/noise.h"
#include "fit/data/standstill.h"
#include "fit/data/stuck_check.h"

namespace axisfit {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Correlation of two lists of changes, about their means or about zero, and the ratio of their
/// sizes: of b to a.
RateRatio compared(Eigen::VectorXd a, Eigen::VectorXd b, bool about_means) {
  if (about_means) {
    a.array() -= a.mean();
    b.array() -= b.mean();
  }
  const double size_a = a.norm(), size_b = b.norm();
  if (!(size_a > 0.0) || !(size_b > 0.0)) return {};
  const double correlation = a.dot(b) / (size_a * size_b);
  return {std::copysign(size_b / size_a, correlation), correlation};
}

ValueCheck check_values(const Recording& recording, const Measurement& measurement,
                        const StuckCheck& stuck_check, const std::vector<double>& command) {
  ValueCheck check;
  const std::vector<double>& values = measurement.values;
  std::tie(check.low, check.high) = std::pair(std::ranges::min(values), std::ranges::max(values));
  check.noise = noise_from_differences(measurement);
  check.resolution = resolution_of(values);
  if (measurement.hold == 1) check.repetition = repetition_of(values);
  // Stairs have the spectrum of a moving average, and the motion that they cause has it, too.
  if (measurement.hold == 1 && check.repetition == 1 && measurement.filter == Filter() &&
      repetition_of(command) == 1)
    check.filter = suspected_filter(values, command);
  const Signal signal = measurement.signal;
  if (signal == Signal::position || signal == Signal::load_position)
    if (const std::optional<Jump> jump = jump_of(recording, measurement, command)) {
      check.jump = jump->size;
      check.jump_at = recording.times[jump->at];
    }
  // A position that stays is an arm at rest, or at its stop; the voltages have limits of their own.
  if (signal == Signal::position || signal == Signal::preamplifier_voltage ||
      signal == Signal::motor_voltage)
    return check;
  std::tie(check.clipped, check.clipped_at) = [&] {
    const ClippedValues clipped = stuck_check.clipped(measurement);
    return std::pair(clipped.samples, clipped.value);
  }();
  if (check.clipped > 0) return check;
  if (const EqualValues stuck = stuck_check.stuck(measurement); stuck.size() > 0) {
    check.stuck = stuck.size();
    check.stuck_at = recording.times[stuck.from];
  }
  return check;
}

}  // namespace

Sampling sampling(std::span<const double> times) {
  Sampling result;
  result.samples = times.size();
  if (times.size() < 2) return result;
  result.duration = times.back() - times.front();
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
  result.interval = median(intervals);
  double sum = 0.0;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double d = intervals[i];
    if (d <= 1.5 * result.interval) {
      sum += (d - result.interval) * (d - result.interval);
      continue;
    }
    ++result.gaps;
    if (d > result.largest_gap) {
      result.largest_gap = d;
      result.gap_at = times[i];
    }
  }
  const double even = static_cast<double>(intervals.size() - result.gaps);
  result.jitter = std::sqrt(sum / even) / result.interval;
  return result;
}

std::optional<RateRatio> rate_ratio(std::span<const double> times, std::span<const double> values,
                                    std::span<const double> rate) {
  const std::size_t n = times.size();
  std::vector<double> integral(n, 0.0);
  for (std::size_t i = 1; i < n; ++i)
    integral[i] = integral[i - 1] + 0.5 * (rate[i] + rate[i - 1]) * (times[i] - times[i - 1]);
  RateRatio best;
  for (std::size_t stretches = 4; 2 * stretches < n && stretches <= 512; stretches *= 2) {
    const auto size = static_cast<Eigen::Index>(stretches);
    Eigen::VectorXd changes(size), integrals(size);
    for (std::size_t k = 0; k < stretches; ++k) {
      const std::size_t from = k * (n - 1) / stretches, to = (k + 1) * (n - 1) / stretches;
      changes[static_cast<Eigen::Index>(k)] = values[to] - values[from];
      integrals[static_cast<Eigen::Index>(k)] = integral[to] - integral[from];
    }
    for (const bool about_means : {false, true}) {
      const RateRatio found = compared(changes, integrals, about_means);
      if (std::abs(found.correlation) > std::abs(best.correlation)) best = found;
    }
  }
  if (best.ratio == 0.0) return std::nullopt;
  return best;
}

SuggestedGain suggested_observer_gain(std::span<const double> times,
                                      std::span<const double> position,
                                      std::span<const double> velocity,
                                      std::span<const double> command, double mass) {
  constexpr double kMissing = 0.01, kAboveNoise = 10.0, kBias = 0.25, kNoticeable = 0.03;
  const bool of_velocity = !velocity.empty();
  const std::span<const double> values = of_velocity ? velocity : position;
  const std::size_t n = times.size();
  // Over stretches, so that noise hardly counts.
  const std::size_t stretch = std::max<std::size_t>(1, n / 200);
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t i = stretch; i + stretch < n; i += stretch, ++count) {
    const double before = times[i] - times[i - stretch], after = times[i + stretch] - times[i];
    const double change = of_velocity ? values[i + stretch] - values[i]
                                      : (values[i + stretch] - values[i]) / after -
                                            (values[i] - values[i - stretch]) / before;
    squares += std::pow(change / (of_velocity ? after : 0.5 * (before + after)), 2);
  }
  const double acceleration =
      std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, count)));
  const double noise = noise_from_differences(values);
  const double shown = kMissing * acceleration / (kAboveNoise * noise);
  const double disturbance = mass > 0.0 ? noise_of_input(command) / mass / noise : 0.0;
  const double fastest = std::max(shown, disturbance),
               rate = of_velocity ? fastest : std::sqrt(fastest);
  const Sampling found = sampling(times);
  const double command_noise = noise_of_input(command) / standard_deviation(command);
  double highest = 0.3 / found.interval;
  if (command_noise > kNoticeable)
    highest =
        std::min(highest, kBias / (command_noise * std::sqrt(found.interval * found.duration)));
  if (!std::isfinite(rate)) return {highest};
  const double lowest = std::min(10.0 / found.duration, highest);
  return {std::clamp(rate, lowest, highest), disturbance > shown};
}

namespace {

/// The sampling of the signal with the most samples: the times of several clocks together are never
/// even.
Sampling densest_sampling(const Recording& recording) {
  std::vector<double> densest;
  for (const Measurement& m : recording.measurements) {
    const bool complete = m.uninformative.empty() || m.filter != Filter() || m.hold > 1;
    if (complete) return sampling(recording.times);
    std::vector<double> times;
    for (std::size_t i = 0; i < recording.times.size(); ++i)
      if (!m.uninformative[i]) times.push_back(recording.times[i]);
    if (times.size() > densest.size()) densest = std::move(times);
  }
  return sampling(densest.empty() ? std::vector<double>(recording.times) : densest);
}

/// What comes in the same messages as a signal that is repeated is repeated as often.
void find_frames(const Recording& recording, const std::vector<double>& command,
                 RecordingCheck& check) {
  const auto repeated = std::ranges::find_if(
      check.measurements, [](const ValueCheck& values) { return values.repetition > 1; });
  if (repeated == check.measurements.end()) return;
  const auto index = static_cast<std::size_t>(repeated - check.measurements.begin());
  const std::vector<double>& known = recording.measurements[index].values;
  const std::size_t times = repeated->repetition;
  for (std::size_t m = 0; m < check.measurements.size(); ++m) {
    ValueCheck& values = check.measurements[m];
    const Measurement& measurement = recording.measurements[m];
    if (values.repetition > 1 || measurement.hold > 1 || !changes_with(measurement.values, known))
      continue;
    values.repetition = times;
    values.filter.reset();
  }
  if (check.command.repetition == 1 && changes_with(command, known))
    check.command.repetition = times;
}

}  // namespace

RecordingCheck check_recording(const Recording& recording) {
  RecordingCheck check;
  check.sampling = densest_sampling(recording);
  const std::vector<bool> standstill = at_standstill(recording);
  const std::vector<double> command_values = sampled_command(recording);
  const StuckCheck stuck_check(recording, standstill);
  for (const Measurement& m : recording.measurements)
    check.measurements.push_back(check_values(recording, m, stuck_check, command_values));
  check.command.repetition = repetition_of(command_values);
  find_frames(recording, command_values, check);
  // A command may well end at a limit of the drive; a measured input that ends sharply, amid noise,
  // does so by its sensor.
  if (recording.command.hold == Hold::linear && recording.command.meaning != Meaning::reference) {
    Measurement input;
    input.signal = Signal::motor_current;
    input.values = command_values;
    // Of either sign, where one end shows what it is.
    if (const ClippedValues clipped = stuck_check.clipped(input); clipped.samples > 0) {
      const double limit = std::abs(clipped.value);
      check.command.clipped_at = limit;
      check.command.clipped = static_cast<std::size_t>(
          std::ranges::count(command_values, limit, [](double x) { return std::abs(x); }));
    }
  }
  check.command_is_magnitude = is_magnitude(recording, command_values);
  check.hard_stop = hard_stop(recording, command_values);

  // The command in force from the first sample on.
  const Schedule& command = recording.command;
  const double begin = recording.times.front(), end = recording.times.back();
  double largest = 0.0, held = 0.0;
  bool any = false;
  for (std::size_t k = 0; k < command.times.size(); ++k) {
    const double until = k + 1 < command.times.size() ? command.times[k + 1] : end;
    if (until <= begin || command.times[k] > end) continue;
    const double value = command.values[k];
    check.command.low = any ? std::min(check.command.low, value) : value;
    check.command.high = any ? std::max(check.command.high, value) : value;
    any = true;
    if (command.times[k] > begin) ++check.switches;
    if (std::abs(value) > largest) {
      largest = std::abs(value);
      held = 0.0;
    }
    if (std::abs(value) == largest) held += until - std::max(begin, command.times[k]);
  }
  check.at_maximum = largest > 0.0 && end > begin ? held / (end - begin) : 0.0;

  for (const auto& [rate, of] : {std::pair(Signal::velocity, Signal::position),
                                 std::pair(Signal::acceleration, Signal::velocity)}) {
    const Measurement *a = recording.find(of), *b = recording.find(rate);
    if (a == nullptr || b == nullptr) continue;
    const auto found = rate_ratio(recording.times, a->values, b->values);
    if (found && found->related()) check.rates.push_back({rate, of, *found});
  }
  if (const Measurement* velocity = recording.find(Signal::velocity)) {
    for (const double v : velocity->values) check.speed = std::max(check.speed, std::abs(v));
  } else if (const Measurement* position = recording.find(Signal::position)) {
    // Over a hundredth of the recording, where rounding is nothing beside the way.
    const std::size_t n = position->values.size(), step = std::max<std::size_t>(1, n / 100);
    for (std::size_t i = step; i < n; i += step)
      check.speed =
          std::max(check.speed, std::abs((position->values[i] - position->values[i - step]) /
                                         (recording.times[i] - recording.times[i - step])));
  }
  return check;
}

std::vector<RecordingCheck> check_recordings(const Job& job) {
  std::vector<RecordingCheck> checks;
  for (const Recording& recording : job.recordings) checks.push_back(check_recording(recording));
  return checks;
}

}  // namespace axisfit
