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
#include "report/text/words.h"

namespace axisfit {
namespace {

/// A number for the eye.
std::string short_number(double value) { return fmt::format("{:.4g}", value); }
std::string short_number(double value, std::string_view unit) {
  return with_unit(short_number(value), unit);
}

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
     "Use mm/s instead of m/s if the velocity is stored in mm/s, or m instead of mm for the "
     "position.",
     "Use m/s instead of mm/s if the velocity is stored in m/s, or mm instead of m for the "
     "position."},
    {Signal::velocity, 1e6,
     "Use um/s instead of m/s if the velocity is stored in um/s, or m instead of um for the "
     "position.",
     "Use m/s instead of um/s if the velocity is stored in m/s, or um instead of m for the "
     "position."},
    {Signal::velocity, 60.0, "The velocity is per minute: use m/min instead of m/s.",
     "The velocity is per second: use m/s instead of m/min."},
    {Signal::velocity, 6e4, "The velocity is per minute: use mm/min instead of m/s.",
     "The velocity is per second: use m/s instead of mm/min."},
    {Signal::velocity, 30.0 / kPi,
     "This looks like rpm instead of rad/s: multiply the velocity by 0.10472.",
     "This looks like rad/s instead of rpm: multiply the velocity by 9.5493."},
    {Signal::velocity, 180.0 / kPi,
     "This looks like degrees instead of radians: multiply the velocity by 0.017453.",
     "This looks like radians instead of degrees: multiply the velocity by 57.296."},
    {Signal::acceleration, 1e3,
     "Use mm/s^2 instead of m/s^2 if the acceleration is stored in mm/s^2, or m/s instead of mm/s "
     "for the velocity.",
     "Use m/s^2 instead of mm/s^2 if the acceleration is stored in m/s^2, or mm/s instead of m/s "
     "for the velocity."},
    {Signal::acceleration, 9.80665, "It is not in g: remove the factor 9.80665.",
     "It is in g: use 'unit: m/s^2, factor: 9.80665'."},
    {Signal::acceleration, 60.0, "The velocity is per second: use m/s instead of m/min.",
     "The velocity is per minute: use m/min instead of m/s."},
};

std::string rate_warning(const RateCheck& rate) {
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
    text += cause == std::end(kCauses) ? "No unit explains this: is there a gear between the two?"
            : size > 1.0               ? cause->too_large
                                       : cause->too_small;
  }
  if (ratio < 0.0) text += " Their signs differ: use 'sign: -1' for one of them.";
  return text;
}

/// Speed per volt that a velocity loop settles at; zero where there is none.
double command_gain(const Model<double>& model) {
  const auto& a = model.axis;
  if (!capabilities(model.structure).is_electric || !(a.K_2 * a.K_t > 0.0)) return 0.0;
  return a.K_1 * a.r_g / (a.K_2 * a.K_t);
}

bool drives_by_force(const Recording& recording, const Model<double>& model) {
  static const std::size_t kGain = find_quantity("K_f")->index;
  return capabilities(model.structure).is_force_driven &&
         std::ranges::any_of(recording.overrides, [](const auto& o) { return o.first == kGain; });
}

std::string header_text(const Recording& recording, const Sampling& sampling) {
  std::string text = fmt::format(
      "{} ({}): {} samples in {} s, {} Hz", recording.name, role_name(recording, true),
      sampling.samples, short_number(sampling.duration), short_number(1.0 / sampling.interval));
  if (sampling.jitter > 1e-3) text += fmt::format(", jitter {:.2g} %", 100.0 * sampling.jitter);
  text += sampling.gaps == 0   ? ", no gaps"
          : sampling.gaps == 1 ? ", one gap"
                               : fmt::format(", {} gaps", sampling.gaps);
  return paragraph(text);
}

}  // namespace

std::vector<std::string> warnings_for(const Job& job, const Recording& recording,
                                      const RecordingCheck& check) {
  std::vector<std::string> warnings;
  const auto warn = [&](std::string text) { warnings.push_back(std::move(text)); };
  const Sampling& sampling = check.sampling;
  if (sampling.gaps > 0)
    warn(fmt::format(
        "{} {} s at {} s. The command is unknown there: trim the recording, or split it in two.",
        sampling.gaps == 1 ? "A gap of" : fmt::format("{} gaps, the largest of", sampling.gaps),
        short_number(sampling.largest_gap), short_number(sampling.gap_at)));
  if (sampling.jitter > 0.1)
    warn(
        fmt::format("Sampling is uneven, with a jitter of {:.2g} %. If the clock is even and only "
                    "the time stamps are not, use sample numbers instead; otherwise give every "
                    "sigma, because its estimate needs even sampling.",
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
    warn(
        fmt::format("velocity and acceleration are both {:.5g} times the derivative: the unit of "
                    "time is wrong. {}",
                    ratio,
                    std::abs(std::log(ratio / 1e3)) < kSameUnit   ? "Use 'unit: ms'."
                    : std::abs(std::log(ratio * 1e3)) < kSameUnit ? "Use 'unit: s'."
                                                                  : "Correct it."));
  } else {
    if (sampling.interval > 0.2 || sampling.interval < 2e-6)
      warn(
          fmt::format("Samples are {} s apart. Is the unit of time right? For milliseconds use "
                      "'unit: ms', for microseconds 'unit: us'.",
                      short_number(sampling.interval)));
    for (const RateCheck& rate : check.rates)
      if (std::string warning = rate_warning(rate); !warning.empty()) warn(std::move(warning));
  }
  const double largest = std::max(std::abs(check.command.low), std::abs(check.command.high));
  if (!(largest > 0.0)) warn("The command is zero throughout: is that the right column?");
  const double reach = command_gain(job.model) * largest;
  if (reach > 0.0 && check.speed > 0.0 &&
      (check.speed > 3.0 * reach || check.speed < reach / 30.0)) {
    warn(fmt::format(
        "The arm reaches {} m/s, but at its largest command, {} V, the axis file gives {} m/s. "
        "Check the units of the command and of the {}, and K_1, K_2, K_t and r_g.",
        short_number(check.speed), short_number(largest), short_number(reach),
        recording.find(Signal::velocity) ? "velocity" : "position"));
  }
  for (std::size_t m = 0; m < check.measurements.size(); ++m) {
    const ValueCheck& values = check.measurements[m];
    const Measurement& measurement = recording.measurements[m];
    const SignalInfo& signal = info(measurement.signal);
    if (values.high == values.low)
      warn(fmt::format("{} is constant: is that the right column?", signal.name));
    if (values.stuck > 0)
      warn(fmt::format(
          "{} has the same value in {} samples from {} s on, while the arm moves: the sensor is "
          "stuck. Trim the recording, or do not fit the signal ('fit: false').",
          signal.name, values.stuck, short_number(values.stuck_at)));
    if (values.clipped > 0)
      warn(
          fmt::format("{} is exactly {} in {} samples: it is clipped at the end of its range. "
                      "Record with a wider range, or do not fit the signal ('fit: false').",
                      signal.name, short_number(values.clipped_at, signal.unit), values.clipped));
    if (measurement.noise == NoiseSource::given && values.noise > 0.0 &&
        (values.noise > 3.0 * measurement.sigma || values.noise < measurement.sigma / 10.0))
      warn(
          fmt::format("{} scatters by {} from sample to sample, but its sigma is {}. Without a "
                      "sigma the scatter is used.",
                      signal.name, short_number(values.noise, signal.unit),
                      short_number(measurement.sigma, signal.unit)));
  }
  return warnings;
}

std::string recordings_text(const Job& job, const std::vector<RecordingCheck>& checks) {
  std::string text = "What the recordings show\n";
  for (std::size_t r = 0; r < checks.size(); ++r) {
    const Recording& recording = job.recordings[r];
    const RecordingCheck& check = checks[r];
    text += header_text(recording, check.sampling);
    const bool force = drives_by_force(recording, job.model);
    std::vector<std::vector<std::string>> rows{
        {"", "lowest", "highest", "unit", "sigma", "noise", "resolution", ""}};
    rows.push_back({force ? "drive_force" : "command", short_number(check.command.low),
                    short_number(check.command.high), force ? "N" : "V", "", "", "",
                    fmt::format("{} switches", check.switches)});
    const double largest = std::max(std::abs(check.command.low), std::abs(check.command.high));
    if (!force && largest >= job.controller.limit && check.at_maximum > 0.01)
      rows.back().back() = fmt::format("at limit {:.0f} %", 100.0 * check.at_maximum);
    for (std::size_t m = 0; m < check.measurements.size(); ++m) {
      const ValueCheck& values = check.measurements[m];
      const Measurement& measurement = recording.measurements[m];
      std::string remark = measurement.fitted ? "" : "not fitted";
      for (const RateCheck& rate : check.rates)
        if (rate.rate == measurement.signal)
          remark = fmt::format("{:.4g} x d/dt", rate.found.ratio);
      const SignalInfo& signal = info(measurement.signal);
      rows.push_back({std::string(signal.name), short_number(values.low), short_number(values.high),
                      std::string(signal.unit), fmt::format("{:.2g}", measurement.sigma),
                      fmt::format("{:.2g}", values.noise),
                      values.resolution > 0.0 ? fmt::format("{:.3g}", values.resolution) : "none",
                      remark});
    }
    text +=
        format_table(rows, {Alignment::left, Alignment::right, Alignment::right, Alignment::left,
                            Alignment::right, Alignment::right, Alignment::right, Alignment::left});
    for (const std::string& warning : warnings_for(job, recording, check))
      text += paragraph("! " + warning, 2);
  }
  return text;
}

std::string run_time_text(const Job& job, const RunTimeEstimate& run_time) {
  const int threads = thread_count(job.options.threads);
  const std::string time = run_time.expected < 1.0 ? "about a second"
                           : run_time.expected < 90.0
                               ? fmt::format("about {:g} s", one_digit(run_time.expected))
                               : fmt::format("about {:g} min", one_digit(run_time.expected / 60.0));
  return paragraph(
      fmt::format("Estimated run time: {} on this machine with {} thread{}; up to ten times that "
                  "if the model does not explain the recordings.",
                  time, threads, threads == 1 ? "" : "s"));
}

}  // namespace axisfit
