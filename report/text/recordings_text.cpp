#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "base/text_table.h"
#include "base/units.h"
#include "init/column_guess.h"
#include "report/text/report_text.h"

namespace axisfit {
namespace {

/// A number for the eye.
std::string figure(double value) { return fmt::format("{:.4g}", value); }
std::string figure(double value, std::string_view unit) { return with_unit(figure(value), unit); }

double one_digit(double value) { return std::stod(fmt::format("{:.0e}", value)); }

/// Where a rate that is too large or too small by a factor usually comes from, in a job that does
/// not say so.
struct Cause {
  Signal rate;
  double factor;
  std::string_view too_large, too_small;  ///< sentences
};

constexpr double kPi = std::numbers::pi;
constexpr Cause kCauses[]{
    {Signal::velocity, 1e3,
     "Say mm/s for m/s if the velocity is stored so, or m for mm of the position.",
     "Say m/s for mm/s if the velocity is stored so, or mm for m of the position."},
    {Signal::velocity, 1e6,
     "Say um/s for m/s if the velocity is stored so, or m for um of the position.",
     "Say m/s for um/s if the velocity is stored so, or um for m of the position."},
    {Signal::velocity, 60.0, "The velocity is per minute: say m/min for m/s.",
     "The velocity is per second: say m/s for m/min."},
    {Signal::velocity, 6e4, "The velocity is per minute: say mm/min for m/s.",
     "The velocity is per second: say m/s for mm/min."},
    {Signal::velocity, 30.0 / kPi, "As rpm for rad/s: multiply the velocity by 0.10472.",
     "As rad/s for rpm: multiply the velocity by 9.5493."},
    {Signal::velocity, 180.0 / kPi, "As degrees for radians: multiply the velocity by 0.017453.",
     "As radians for degrees: multiply the velocity by 57.296."},
    {Signal::acceleration, 1e3,
     "Say mm/s^2 for m/s^2 if the acceleration is stored so, or m/s for mm/s of the velocity.",
     "Say m/s^2 for mm/s^2 if the acceleration is stored so, or mm/s for m/s of the velocity."},
    {Signal::acceleration, 9.80665, "It is not in g: no factor 9.80665.",
     "It is in g: say 'unit: m/s^2, factor: 9.80665'."},
    {Signal::acceleration, 60.0, "The velocity is per second: say m/s for m/min.",
     "The velocity is per minute: say m/min for m/s."},
};

std::string rate_concern(const RateCheck& rate) {
  const double ratio = rate.found.ratio, size = std::abs(ratio);
  const std::string_view name = info(rate.rate).name, of = info(rate.of).name;
  const bool scaled = std::abs(std::log(size)) > kSameUnit;
  if (!scaled && ratio > 0.0) return {};
  std::string text = fmt::format("{} is {:.5g} times the derivative of the {}.", name, ratio, of);
  if (scaled) {
    const auto* cause = std::ranges::find_if(kCauses, [&](const Cause& c) {
      return c.rate == rate.rate &&
             std::abs(std::abs(std::log(size)) - std::log(c.factor)) < kSameUnit;
    });
    text += " ";
    text += cause == std::end(kCauses) ? "No unit explains that: a gear between the two?"
            : size > 1.0               ? cause->too_large
                                       : cause->too_small;
  }
  if (ratio < 0.0) text += " Their signs differ: say 'sign: -1' for one of them.";
  return text;
}

/// Speed per volt that a velocity loop settles at; zero where there is none.
double command_gain(const Model<double>& model) {
  const auto& a = model.axis;
  if (model.structure.drive == Drive::force_source || !(a.K_2 * a.K_t > 0.0)) return 0.0;
  return a.K_1 * a.r_g / (a.K_2 * a.K_t);
}

bool drives_by_force(const Recording& recording, const Model<double>& model) {
  static const std::size_t kGain = find_quantity("K_f")->index;
  return model.structure.drive == Drive::force_source &&
         std::ranges::any_of(recording.overrides, [](const auto& o) { return o.first == kGain; });
}

std::string header_text(const Recording& recording, const Sampling& sampling) {
  std::string text =
      fmt::format("{} ({}): {} samples in {} s, {} Hz", recording.name, role_name(recording, true),
                  sampling.samples, figure(sampling.duration), figure(1.0 / sampling.interval));
  if (sampling.jitter > 1e-3) text += fmt::format(", jitter {:.2g} %", 100.0 * sampling.jitter);
  text += sampling.gaps == 0   ? ", no gaps"
          : sampling.gaps == 1 ? ", one gap"
                               : fmt::format(", {} gaps", sampling.gaps);
  return paragraph(text);
}

}  // namespace

std::vector<std::string> concerns_of(const Job& job, const Recording& recording,
                                     const RecordingCheck& check) {
  std::vector<std::string> concerns;
  const auto say = [&](std::string text) { concerns.push_back(std::move(text)); };
  const Sampling& sampling = check.sampling;
  if (sampling.gaps > 0)
    say(fmt::format(
        "{} {} s at {} s. What the command did there is not known: trim the recording, "
        "or make two of it.",
        sampling.gaps == 1 ? "A gap of" : fmt::format("{} gaps, the largest of", sampling.gaps),
        figure(sampling.largest_gap), figure(sampling.gap_at)));
  if (sampling.jitter > 0.1)
    say(
        fmt::format("Samples come unevenly, {:.2g} % off on average. If the clock is even and only "
                    "the time stamps are not, number the samples instead; else give every sigma, "
                    "whose estimate needs even sampling.",
                    100.0 * sampling.jitter));
  // A wrong unit of the time shows in every rate.
  const bool time =
      check.rates.size() == 2 && std::ranges::all_of(check.rates, [&](const RateCheck& r) {
        return std::abs(std::log(std::abs(r.found.ratio))) > kSameUnit &&
               std::abs(std::log(std::abs(r.found.ratio / check.rates.front().found.ratio))) <
                   kSameUnit;
      });
  if (time) {
    const double ratio = std::abs(check.rates.front().found.ratio);
    say(
        fmt::format("velocity and acceleration both are {:.5g} times a derivative: the unit of the "
                    "time is wrong. {}",
                    ratio,
                    std::abs(std::log(ratio / 1e3)) < kSameUnit   ? "Say 'unit: ms'."
                    : std::abs(std::log(ratio * 1e3)) < kSameUnit ? "Say 'unit: s'."
                                                                  : "Say the right one."));
  } else {
    if (sampling.interval > 0.2 || sampling.interval < 2e-6)
      say(
          fmt::format("Samples are {} s apart. Is the unit of the time right? For milliseconds say "
                      "'unit: ms', for microseconds 'unit: us'.",
                      figure(sampling.interval)));
    for (const RateCheck& rate : check.rates)
      if (std::string concern = rate_concern(rate); !concern.empty()) say(std::move(concern));
  }
  const double largest = std::max(std::abs(check.command.low), std::abs(check.command.high));
  if (!(largest > 0.0)) say("The command is zero throughout: is that its column?");
  const double reach = command_gain(job.model) * largest;
  if (reach > 0.0 && check.speed > 0.0 &&
      (check.speed > 3.0 * reach || check.speed < reach / 30.0)) {
    say(
        fmt::format("The arm gets to {} m/s, but with its largest command, {} V, the axis file "
                    "makes {} m/s. Check the units of the command and of the {}, and K_1, K_2, K_t "
                    "and r_g.",
                    figure(check.speed), figure(largest), figure(reach),
                    recording.find(Signal::velocity) ? "velocity" : "position"));
  }
  for (std::size_t m = 0; m < check.measurements.size(); ++m) {
    const ValueCheck& values = check.measurements[m];
    const Measurement& measurement = recording.measurements[m];
    const SignalInfo& signal = info(measurement.signal);
    if (values.high == values.low)
      say(fmt::format("{} is constant: is that its column?", signal.name));
    if (values.frozen > 0)
      say(
          fmt::format("{} is exactly the same in {} samples from {} s on, while the arm moves: it "
                      "hangs. Trim the recording, or compare only ('fit: false').",
                      signal.name, values.frozen, figure(values.frozen_at)));
    if (values.clipped > 0)
      say(
          fmt::format("{} is exactly {} in {} samples: there it left the range of its instrument. "
                      "Record with a wider one, or compare only ('fit: false').",
                      signal.name, figure(values.clipped_at, signal.unit), values.clipped));
    if (measurement.noise == NoiseSource::given && values.noise > 0.0 &&
        (values.noise > 3.0 * measurement.sigma || values.noise < measurement.sigma / 10.0))
      say(fmt::format(
          "{} scatters by {} from sample to sample, and its sigma says {}. Without a "
          "sigma the scatter is taken.",
          signal.name, figure(values.noise, signal.unit), figure(measurement.sigma, signal.unit)));
  }
  return concerns;
}

std::string recordings_text(const Job& job, const std::vector<RecordingCheck>& checks) {
  std::string text = "What the recordings show\n";
  for (std::size_t r = 0; r < checks.size(); ++r) {
    const Recording& recording = job.recordings[r];
    const RecordingCheck& check = checks[r];
    text += header_text(recording, check.sampling);
    const bool force = drives_by_force(recording, job.model);
    std::vector<std::vector<std::string>> rows{
        {"", "lowest", "highest", "unit", "sigma", "noise", "grid", ""}};
    rows.push_back({force ? "drive_force" : "command", figure(check.command.low),
                    figure(check.command.high), force ? "N" : "V", "", "", "",
                    fmt::format("{} switches", check.switches)});
    const double largest = std::max(std::abs(check.command.low), std::abs(check.command.high));
    if (!force && largest >= job.controller.limit && check.at_largest > 0.01)
      rows.back().back() = fmt::format("at limit {:.0f} %", 100.0 * check.at_largest);
    for (std::size_t m = 0; m < check.measurements.size(); ++m) {
      const ValueCheck& values = check.measurements[m];
      const Measurement& measurement = recording.measurements[m];
      std::string remark = measurement.fitted ? "" : "not fitted";
      for (const RateCheck& rate : check.rates)
        if (rate.rate == measurement.signal)
          remark = fmt::format("{:.4g} x d/dt", rate.found.ratio);
      const SignalInfo& signal = info(measurement.signal);
      rows.push_back({std::string(signal.name), figure(values.low), figure(values.high),
                      std::string(signal.unit), fmt::format("{:.2g}", measurement.sigma),
                      fmt::format("{:.2g}", values.noise),
                      values.grid > 0.0 ? fmt::format("{:.3g}", values.grid) : "none", remark});
    }
    text += aligned(rows, {Set::left, Set::right, Set::right, Set::left, Set::right, Set::right,
                           Set::right, Set::left});
    for (const std::string& concern : concerns_of(job, recording, check))
      text += paragraph("! " + concern, 2);
  }
  return text;
}

std::string effort_text(const Job& job, const Effort& effort) {
  const int threads = thread_count(job.options.threads);
  const std::string time = effort.expected < 1.0 ? "about a second"
                           : effort.expected < 90.0
                               ? fmt::format("about {:g} s", one_digit(effort.expected))
                               : fmt::format("about {:g} min", one_digit(effort.expected / 60.0));
  return paragraph(fmt::format(
      "The fit will take {} on this machine with {} thread{}; if the model does not explain the "
      "recordings, up to ten times that.",
      time, threads, threads == 1 ? "" : "s"));
}

}  // namespace axisfit
