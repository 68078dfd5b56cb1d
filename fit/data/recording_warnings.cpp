#include "fit/data/recording_warnings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace axisfit {
namespace {

/// Whether a magnitude is that of a unit, as far as noise allows to tell.
bool is_about(double size, double unit) { return std::abs(std::log(size / unit)) < kSameUnit; }

/// The size, or its inverse, by which a mistaken unit makes a rate wrong.
struct KnownMistake {
  Signal rate;
  double factor;
  UnitMistake mistake;
};
constexpr KnownMistake kKnownMistakes[]{
    {Signal::velocity, 1e3, UnitMistake::milli},
    {Signal::velocity, 1e6, UnitMistake::micro},
    {Signal::velocity, 60.0, UnitMistake::minute},
    {Signal::velocity, 6e4, UnitMistake::milli_per_minute},
    {Signal::velocity, 30.0 / std::numbers::pi, UnitMistake::rpm},
    {Signal::velocity, 180.0 / std::numbers::pi, UnitMistake::degrees},
    {Signal::acceleration, 1e3, UnitMistake::milli},
    {Signal::acceleration, 9.80665, UnitMistake::standard_gravity},
    {Signal::acceleration, 60.0, UnitMistake::minute},
};

std::optional<UnitMistake> mistake_of(const RateCheck& rate) {
  const double size = std::exp(std::abs(std::log(std::abs(rate.found.ratio))));
  const auto* known = std::ranges::find_if(kKnownMistakes, [&](const KnownMistake& e) {
    return e.rate == rate.rate && is_about(size, e.factor);
  });
  return known == std::end(kKnownMistakes) ? std::nullopt : std::optional(known->mistake);
}

/// Speed per volt that a velocity loop settles at; zero where there is none.
double command_gain(const Model<double>& model) {
  const auto& a = model.axis;
  if (!capabilities(model.structure).is_electric || !(a.K_2 * a.K_t > 0.0)) return 0.0;
  return a.K_1 * motor_radius(model) / (a.K_2 * a.K_t);
}

/// A wrong unit of the time shows in every rate.
std::optional<warning::TimeUnit> wrong_time_unit(const std::vector<RateCheck>& rates) {
  if (rates.size() != 2) return std::nullopt;
  const double ratio = std::abs(rates.front().found.ratio);
  for (const RateCheck& rate : rates) {
    const double size = std::abs(rate.found.ratio);
    if (!(std::abs(std::log(size)) > kSameUnit) || !is_about(size, ratio)) return std::nullopt;
  }
  using enum warning::TimeUnit::Stored;
  return warning::TimeUnit{ratio, is_about(ratio, 1e3)    ? milliseconds
                                  : is_about(ratio, 1e-3) ? seconds
                                                          : unknown};
}

template <class... Warnings>
bool is_any_of(const RecordingWarning& warning) {
  return (std::holds_alternative<Warnings>(warning) || ...);
}

}  // namespace

bool is_fault(const RecordingWarning& found) {
  using namespace warning;
  return is_any_of<TimeUnit, WrongRate, NoDirection, ClippedInput, OnHardStop, Stuck, Clipped,
                   Jumped>(found);
}

std::vector<RecordingWarning> warnings_of(const Job& job, const Recording& recording,
                                          const RecordingCheck& check) {
  constexpr double kMinInterval = 2e-6, kMaxInterval = 0.2;  // s
  std::vector<RecordingWarning> warnings;
  const Sampling& sampling = check.sampling;
  if (sampling.gaps > 0)
    warnings.push_back(warning::Gaps{sampling.gaps, sampling.largest_gap, sampling.gap_at});
  if (!sampling.is_even()) warnings.push_back(warning::UnevenSampling{sampling.jitter});
  if (const auto time = wrong_time_unit(check.rates)) {
    warnings.push_back(*time);
  } else {
    if (sampling.interval > kMaxInterval || sampling.interval < kMinInterval)
      warnings.push_back(warning::UnlikelyInterval{sampling.interval});
    for (const RateCheck& rate : check.rates) {
      const bool wrong_size = std::abs(std::log(std::abs(rate.found.ratio))) > kSameUnit;
      if (wrong_size)
        warnings.push_back(warning::WrongRate{rate, true, mistake_of(rate)});
      else if (!(rate.found.ratio > 0.0))
        warnings.push_back(warning::WrongRate{rate});
    }
  }

  const double largest = std::max(std::abs(check.command.low), std::abs(check.command.high));
  if (!(largest > 0.0)) warnings.push_back(warning::NoCommand());
  if (check.command_is_magnitude)
    warnings.push_back(warning::NoDirection{std::abs(check.command.high) == largest});
  // A command that a drive takes every few samples is a staircase. What was measured is none, nor
  // is it likely where the measured signals come as seldom.
  const bool in_frames = std::ranges::any_of(check.measurements, [&](const ValueCheck& values) {
    return values.repetition == check.command.repetition;
  });
  if (check.command.repetition > 1 && (in_frames || recording.command.hold == Hold::linear))
    warnings.push_back(warning::RepeatedInput{check.command.repetition});
  if (check.command.clipped > 0)
    warnings.push_back(warning::ClippedInput{check.command.clipped, check.command.clipped_at});
  if (check.hard_stop) warnings.push_back(warning::OnHardStop{*check.hard_stop});
  // Friction and a short run keep the arm slower than expected; little makes it faster.
  constexpr double kMaxExcess = 3.0, kMaxDeficit = 30.0;
  const double expected = command_gain(job.model) * largest;
  if (expected > 0.0 && check.speed > 0.0 &&
      (check.speed > kMaxExcess * expected || check.speed < expected / kMaxDeficit))
    warnings.push_back(warning::UnlikelySpeed{
        check.speed, largest, expected,
        recording.find(Signal::velocity) ? Signal::velocity : Signal::position});

  for (std::size_t m = 0; m < check.measurements.size(); ++m) {
    const ValueCheck& values = check.measurements[m];
    const Measurement& measurement = recording.measurements[m];
    const Signal signal = measurement.signal;
    if (values.high == values.low) warnings.push_back(warning::Constant{signal});
    if (values.stuck > 0) warnings.push_back(warning::Stuck{signal, values.stuck, values.stuck_at});
    if (values.clipped > 0)
      warnings.push_back(warning::Clipped{signal, values.clipped, values.clipped_at});
    if (values.jump != 0.0)
      warnings.push_back(warning::Jumped{signal, values.jump, values.jump_at});
    if (measurement.missing > 0)
      warnings.push_back(warning::Missing{signal, measurement.missing, recording.times.size()});
    if (values.repetition > 1) warnings.push_back(warning::Repeated{signal, values.repetition});
    if (values.filter && sampling.is_even())
      warnings.push_back(warning::Filtered{signal, values.filter->corner / sampling.interval,
                                           values.filter->average});
    constexpr double kMaxExcessScatter = 3.0, kMaxExcessSigma = 10.0;
    if (measurement.noise == NoiseSource::given && values.noise > 0.0 &&
        (values.noise > kMaxExcessScatter * measurement.sigma ||
         values.noise < measurement.sigma / kMaxExcessSigma))
      warnings.push_back(warning::UnlikelySigma{signal, values.noise, measurement.sigma});
  }
  return warnings;
}

}  // namespace axisfit
