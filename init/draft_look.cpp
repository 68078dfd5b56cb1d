#include "init/draft_look.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/rounding.h"
#include "base/units.h"
#include "fit/data/recording_check.h"
#include "fit/estimate/estimate.h"
#include "fit/estimate/recipes.h"
#include "init/free_choice.h"
#include "io/config/yaml_text.h"

namespace axisfit {
namespace {

std::optional<FirstLook> look_at(const JobDraft& draft, const FirstLookOptions& options) {
  std::vector<std::vector<double>> inputs;
  for (const DraftRecording& recording : draft.recordings) inputs.push_back(recording.driving());
  std::vector<DrivenMotion> motions;
  for (std::size_t r = 0; r < inputs.size(); ++r)
    motions.push_back(driven_motion(draft.recordings[r].guess, inputs[r]));
  return first_look(motions, options);
}

/// Whether the values stay for most of the time, as those that somebody chose.
bool stays_in_steps(std::span<const double> values) {
  constexpr double kMostly = 0.8;
  std::size_t equal = 0;
  for (std::size_t i = 1; i < values.size(); ++i) equal += values[i] == values[i - 1] ? 1 : 0;
  return static_cast<double>(equal) > kMostly * static_cast<double>(values.size());
}

void turn_input(JobDraft& draft) {
  for (DraftRecording& recording : draft.recordings) {
    GuessedColumn& input = recording.input_column();
    input.negative = !input.negative;
    for (double& x : input.values) x = -x;
  }
}

void say_of_input(JobDraft& draft, const std::string& reason) {
  for (DraftRecording& recording : draft.recordings) {
    recording.input_column().reasons.push_back(reason);
    recording.input_column().guessed = true;
  }
}

/// "-3.2 +- 0.1"
std::string text_of(const FirstLook::Term& estimated) {
  return fmt::format("{:.3g} +- {:.1g}", estimated.value, estimated.error);
}

/// Whether the input acts along the motion in one recording and against it in another.
bool contradict_each_other(const JobDraft& draft) {
  bool any_along = false, any_turned = false;
  for (const DraftRecording& recording : draft.recordings) {
    const std::vector<double> input = recording.driving();
    const DrivenMotion motion = driven_motion(recording.guess, input);
    const auto look = first_look(std::span(&motion, 1));
    any_along = any_along || (look && look->direction == FirstLook::Direction::along);
    any_turned = any_turned || (look && look->direction == FirstLook::Direction::turned);
  }
  return any_along && any_turned;
}

void correct_sign_of_force(JobDraft& draft) {
  using enum FirstLook::Direction;
  if (!draft.look) return;
  if (contradict_each_other(draft)) draft.look->direction = open;
  if (draft.look->direction == along) return;
  const FirstLook& look = *draft.look;
  const std::string figures = fmt::format(
      "as it is recorded, the power that friction takes comes out as {} and the {} as {} (units of "
      "the recording)",
      text_of(look.dissipation), draft.say("mass"), text_of(look.mass));
  if (look.direction == open) {
    say_of_input(draft, figures + ": is its sign right? It was left as it is");
    return;
  }
  turn_input(draft);
  draft.look = look_at(draft);
  say_of_input(draft, figures + ": its sign was inverted");
}

/// By what the motion and the input of a velocity loop have in common: near one where it goes the
/// way of the input, near minus one where it goes the other way.
std::optional<double> agreement(const DraftRecording& recording) {
  const GuessedColumn* position = recording.guess.find(Kind::position);
  if (position == nullptr || recording.input->key != std::string_view("command")) return {};
  const auto found = rate_ratio(recording.guess.time.values, position->values, recording.driving());
  return found ? std::optional(found->correlation) : std::nullopt;
}

void correct_sign_of_velocity(JobDraft& draft) {
  constexpr double kClear = 0.8, kSome = 0.5;
  double least = 1.0, most = -1.0;
  std::vector<std::string> each;
  for (const DraftRecording& recording : draft.recordings) {
    const double found = agreement(recording).value_or(0.0);
    least = std::min(least, found);
    most = std::max(most, found);
    each.push_back(draft.recordings.size() > 1 ? fmt::format("{:.2f} in {}", found, recording.name)
                                               : fmt::format("{:.2f}", found));
  }
  if (least > -kSome) return;
  const bool is_turned = least < -kClear && most <= kClear;
  if (is_turned) turn_input(draft);
  say_of_input(draft, fmt::format("the axis moves in the opposite direction (correlation {}): {}",
                                  fmt::join(each, ", "),
                                  is_turned ? "its sign was inverted"
                                            : "is its sign right? It was left as it is"));
}

/// The reduced chi-square of a short fit of the job; infinite where there is none.
double chi_square_of(const JobDraft& draft) {
  constexpr std::size_t kMostSamples = 20000;
  Job job = draft_job(draft);
  std::size_t samples = 0;
  for (const Recording& r : job.recordings) samples += r.times.size();
  if (samples > kMostSamples) return INFINITY;
  job.options = recipe::quick(job.options);
  const FitResult fit = estimate(job);
  return fit.verdict.has_minimum() ? fit.reduced_chi_square : INFINITY;
}

}  // namespace

DrivenMotion driven_motion(const RecordingGuess& recording, std::span<const double> input) {
  DrivenMotion motion{recording.time.values, {}, {}, input};
  if (const GuessedColumn* position = recording.find(Kind::position))
    motion.position = position->values;
  if (const GuessedColumn* velocity = recording.find(Kind::velocity))
    motion.velocity = velocity->values;
  return motion;
}

std::optional<FirstLook> look_at(const JobDraft& draft) {
  if (!draft.is_force_driven()) return std::nullopt;
  const auto plain = look_at(draft, {});
  if (draft.vocabulary().joint != Joint::revolute) return plain;
  const auto with_gravity = look_at(draft, {.with_gravity = true});
  constexpr double kClearlyLess = 0.8;
  return with_gravity && (!plain || with_gravity->unexplained < kClearlyLess * plain->unexplained)
             ? with_gravity
             : plain;
}

void correct_signs(JobDraft& draft) {
  draft.is_force_driven() ? correct_sign_of_force(draft) : correct_sign_of_velocity(draft);
}

void set_timing(JobDraft& draft) {
  if (!draft.is_force_driven() || draft.joined) return;
  const auto set_hold = [&](bool is_held, const std::string& reason) {
    for (DraftRecording& recording : draft.recordings) {
      recording.is_held = is_held;
      recording.hold_reason = reason;
    }
  };
  const bool is_measured = draft.recordings.front().has_measured_input();
  const bool is_stepped = std::ranges::any_of(draft.recordings, [](const DraftRecording& r) {
    return stays_in_steps(r.input_column().values);
  });
  // Whether the motion goes better with the other hold.
  const auto try_hold = [&](bool is_held, const std::string& reason) {
    const double before = chi_square_of(draft);
    set_hold(is_held, reason);
    constexpr double kBetter = 0.99;  // thousands of samples make less than that by chance
    if (chi_square_of(draft) < kBetter * before) return true;
    set_hold(false, {});
    return false;
  };
  if (is_measured && is_stepped) try_hold(true, ": it stays in steps, and so does the force");
  if (!draft.look || draft.look->direction == FirstLook::Direction::open) return;
  const double interval = sampling(draft.recordings.front().guess.time.values).interval;
  const FirstLook::Term& delay = draft.look->delay;
  // A value that is held acts half a sample later than one that goes straight to the next.
  const double straight = delay.value, held = delay.value - 0.5 * interval;
  const bool is_held = draft.recordings.front().holds_input();
  double left = is_held ? held : straight;
  const double other = is_held ? straight : held;
  constexpr double kAsGoodAsZero = 0.2, kClear = 0.4, kKnown = 0.1;  // samples
  if (delay.error < kKnown * interval && std::abs(other) < kAsGoodAsZero * interval &&
      std::abs(left) > kClear * interval) {
    if (try_hold(!is_held, ": the motion goes better with it")) left = other;
  }
  if (std::abs(left) < std::max(0.5 * interval, FirstLook::kSure * delay.error)) return;
  const Quantity& quantity = draft.quantity("T_d").quantity;
  const double most =
      std::min(quantity.upper, round_to_digits(std::max(20.0 * interval, 2.0 * std::abs(left)), 2));
  draft.parameters.push_back(
      {"T_d",
       fmt::format("{{initial: {}, bounds: [{}, {}]}}", with_unit(round_to_digits(left, 2), "s"),
                   with_unit(std::max(quantity.lower, -most), "s"), with_unit(most, "s"))});
  draft.guesses.push_back(
      fmt::format("T_d is free: the motion {} what drives it by {:.2g} ms; it is the time lag of "
                  "drive or log",
                  left > 0.0 ? "follows" : "is logged before", 1e3 * std::abs(left)));
}

}  // namespace axisfit
