#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/rounding.h"
#include "base/units.h"
#include "report/text/report_text.h"
#include "report/text/words.h"

namespace axisfit {
namespace {

std::string short_number(double value) { return fmt::format("{:.4g}", value); }

/// What the signals are called.
struct Names {
  Vocabulary vocabulary;

  std::string_view operator()(Signal signal) const { return info(signal, vocabulary).name; }
  std::string value(double value, Signal signal) const {
    return with_unit(short_number(value), info(signal, vocabulary).unit);
  }
};

/// Where a rate that is too large or too small usually comes from, in a job that has no such unit.
struct Advice {
  Signal rate;
  UnitMistake mistake;
  std::string_view too_large, too_small;  ///< sentences
};

constexpr Advice kOfSliding[]{
    {Signal::velocity, UnitMistake::milli,
     "Use mm/s instead of m/s if the velocity is stored in mm/s, or m instead of mm for the "
     "position.",
     "Use m/s instead of mm/s if the velocity is stored in m/s, or mm instead of m for the "
     "position."},
    {Signal::velocity, UnitMistake::micro,
     "Use um/s instead of m/s if the velocity is stored in um/s, or m instead of um for the "
     "position.",
     "Use m/s instead of um/s if the velocity is stored in m/s, or um instead of m for the "
     "position."},
    {Signal::velocity, UnitMistake::minute, "The velocity is per minute: use m/min instead of m/s.",
     "The velocity is per second: use m/s instead of m/min."},
    {Signal::velocity, UnitMistake::milli_per_minute,
     "The velocity is per minute: use mm/min instead of m/s.",
     "The velocity is per second: use m/s instead of mm/min."},
    {Signal::velocity, UnitMistake::rpm,
     "This looks like rpm instead of rad/s: multiply the velocity by 0.10472.",
     "This looks like rad/s instead of rpm: multiply the velocity by 9.5493."},
    {Signal::velocity, UnitMistake::degrees,
     "This looks like degrees instead of radians: multiply the velocity by 0.017453.",
     "This looks like radians instead of degrees: multiply the velocity by 57.296."},
    {Signal::acceleration, UnitMistake::milli,
     "Use mm/s^2 instead of m/s^2 if the acceleration is stored in mm/s^2, or m/s instead of mm/s "
     "for the velocity.",
     "Use m/s^2 instead of mm/s^2 if the acceleration is stored in m/s^2, or mm/s instead of m/s "
     "for the velocity."},
    {Signal::acceleration, UnitMistake::standard_gravity,
     "It is not in g: remove the factor 9.80665.",
     "It is in g: use 'unit: m/s^2, factor: 9.80665'."},
    {Signal::acceleration, UnitMistake::minute,
     "The velocity is per second: use m/s instead of m/min.",
     "The velocity is per minute: use m/min instead of m/s."},
};
constexpr Advice kOfTurning[]{
    {Signal::velocity, UnitMistake::rpm, "Use rpm instead of rad/s if the velocity is stored so.",
     "Use rad/s instead of rpm if the velocity is stored so."},
    {Signal::velocity, UnitMistake::degrees,
     "Use deg/s instead of rad/s if the velocity is stored so, or rad instead of deg for the "
     "position.",
     "Use rad/s instead of deg/s if the velocity is stored so, or deg instead of rad for the "
     "position."},
    {Signal::velocity, UnitMistake::minute,
     "The velocity is per minute: use 1/min or rpm instead of 1/s.",
     "The velocity is per second: use 1/s instead of 1/min or rpm."},
};

std::string_view advice_on(const warning::WrongRate& w, Vocabulary vocabulary) {
  const std::span<const Advice> known =
      vocabulary.joint == Joint::prismatic ? std::span<const Advice>(kOfSliding) : kOfTurning;
  const auto advice = std::ranges::find_if(
      known, [&](const Advice& a) { return a.rate == w.rate.rate && a.mistake == w.mistake; });
  if (advice == known.end()) return "No unit explains this: is there a gear between the two?";
  return std::abs(w.rate.found.ratio) > 1.0 ? advice->too_large : advice->too_small;
}

std::string text_of(const warning::Gaps& w, const Names&) {
  return fmt::format(
      "{} {} s at {} s. The command is unknown there: trim the recording, or split it in two.",
      w.count == 1 ? "A gap of" : fmt::format("{} gaps, the largest of", w.count),
      short_number(w.largest), short_number(w.at));
}

std::string text_of(const warning::UnevenSampling& w, const Names&) {
  return fmt::format(
      "Sampling is uneven, with a jitter of {:.2g} %. If the clock is even and only the time "
      "stamps are not, use sample numbers instead; otherwise give every sigma, because its "
      "estimate needs even sampling.",
      100.0 * w.jitter);
}

std::string text_of(const warning::TimeUnit& w, const Names&) {
  using enum warning::TimeUnit::Stored;
  return fmt::format(
      "velocity and acceleration are both {:.5g} times the derivative: the unit of time is wrong. "
      "{}",
      w.ratio,
      w.stored == milliseconds ? "Use 'unit: ms'."
      : w.stored == seconds    ? "Use 'unit: s'."
                               : "Correct it.");
}

std::string text_of(const warning::UnlikelyInterval& w, const Names&) {
  return fmt::format(
      "Samples are {} s apart. Is the unit of time right? For milliseconds use 'unit: ms', for "
      "microseconds 'unit: us'.",
      short_number(w.interval));
}

std::string text_of(const warning::WrongRate& w, const Names& name) {
  std::string text = fmt::format("{} is {:.5g} times the derivative of the {}.", name(w.rate.rate),
                                 w.rate.found.ratio, name(w.rate.of));
  if (w.wrong_size) text += fmt::format(" {}", advice_on(w, name.vocabulary));
  if (w.rate.found.ratio < 0.0) text += " Their signs differ: use 'sign: -1' for one of them.";
  return text;
}

std::string text_of(const warning::NoCommand&, const Names&) {
  return "The command is zero throughout: is that the right column?";
}

std::string text_of(const warning::NoDirection& w, const Names& name) {
  return fmt::format(
      "The command is never {}, but the {} goes both ways, as if driven by it in either direction: "
      "the column has the size of the command, and its direction is in another one. Multiply the "
      "two into one column.",
      w.is_positive ? "negative" : "positive", words_on(name.vocabulary, "arm"));
}

std::string text_of(const warning::RepeatedInput& w, const Names&) {
  return fmt::format(
      "The command: each value is recorded {} times. If the drive did not take it as such a "
      "staircase, record it at every sample, or keep only the rows with a new value.",
      w.times);
}

std::string text_of(const warning::ClippedInput& w, const Names& name) {
  return fmt::format(
      "The size of the command is exactly {} in {} samples, and noisy elsewhere: its sensor is at "
      "the end of its range, and the {} beyond is not recorded. Record with a wider range, or what "
      "the drive was told.",
      command_text(w.value, name.vocabulary), w.samples, words_on(name.vocabulary, "force"));
}

std::string text_of(const warning::OnHardStop& w, const Names& name) {
  return fmt::format(
      "The {} runs into a hard stop at {:.6g} s and stays there to the end, while the drive still "
      "pushes. The model has no such stop: exclude it with 'trim: {{to: {:.6g} s}}'.",
      words_on(name.vocabulary, "arm"), w.stop.at, w.stop.last_before);
}

std::string text_of(const warning::UnlikelySpeed& w, const Names& name) {
  return fmt::format(
      "The {} reaches {} {}, but at its largest command, {} V, the axis file gives {} {}. Check "
      "the units of the command and of the {}, and K_1, K_2, K_t and r_g.",
      words_on(name.vocabulary, "arm"), short_number(w.speed), unit_on(name.vocabulary, "m/s"),
      short_number(w.command), short_number(w.expected), unit_on(name.vocabulary, "m/s"),
      name(w.from));
}

std::string text_of(const warning::Constant& w, const Names& name) {
  return fmt::format("{} is constant: is that the right column?", name(w.signal));
}

std::string text_of(const warning::Stuck& w, const Names& name) {
  return fmt::format(
      "{} has the same value in {} samples from {} s on, while the {} moves: the sensor is stuck. "
      "Trim the recording, or do not fit the signal ('fit: false').",
      name(w.signal), w.samples, short_number(w.at), words_on(name.vocabulary, "arm"));
}

std::string text_of(const warning::Clipped& w, const Names& name) {
  return fmt::format(
      "{} is exactly {} in {} samples: it is clipped at the end of its range. Record with a wider "
      "range, or do not fit the signal ('fit: false').",
      name(w.signal), name.value(w.value, w.signal), w.samples);
}

std::string text_of(const warning::Jumped& w, const Names& name) {
  return fmt::format(
      "{} jumps by {} at {} s, and goes on from there: counts or rows are lost, or its zero was "
      "set. Split the recording there, or exclude what is before or behind with 'trim'.",
      name(w.signal), name.value(w.size, w.signal), short_number(w.at));
}

std::string text_of(const warning::Missing& w, const Names& name) {
  return fmt::format(
      "{} has no value in {} of {} samples, which are left out; if it was recorded more slowly "
      "than "
      "the rest, that is as it should be.",
      name(w.signal), w.samples, w.of);
}

std::string text_of(const warning::Repeated& w, const Names& name) {
  return fmt::format("{}: each value is recorded {} times, by a sample and hold. Set 'hold: {}'.",
                     name(w.signal), w.times, w.times);
}

std::string text_of(const warning::Filtered& w, const Names& name) {
  const std::string filter =
      w.average > 0 ? fmt::format(
                          "is a moving average of {} samples: the fit takes that for a part of the "
                          "axis. Set 'filter: {{moving_average: {}}}', with 'zero_phase: true' if "
                          "each is the mean of the samples about it",
                          w.average, w.average)
                    : fmt::format(
                          "hardly has noise above about {:g} Hz: it went through a low-pass "
                          "filter, which the fit takes for a part of the axis. Set 'filter' as the "
                          "drive or recorder has it",
                          round_to_digits(w.corner, 1));
  return fmt::format("{} {}, or record it unfiltered.", name(w.signal), filter);
}

std::string text_of(const warning::UnlikelySigma& w, const Names& name) {
  return fmt::format(
      "{} scatters by {} from sample to sample, but its sigma is {}. Without a sigma the scatter "
      "is used.",
      name(w.signal), name.value(w.scatter, w.signal), name.value(w.sigma, w.signal));
}

}  // namespace

std::string warning_text(const RecordingWarning& warning, Vocabulary vocabulary) {
  return std::visit([&](const auto& w) { return text_of(w, Names{vocabulary}); }, warning);
}

std::vector<std::string> warnings_for(const Job& job, const Recording& recording,
                                      const RecordingCheck& check) {
  std::vector<std::string> texts;
  for (const RecordingWarning& warning : warnings_of(job, recording, check))
    texts.push_back(warning_text(warning, job.vocabulary()));
  return texts;
}

}  // namespace axisfit
