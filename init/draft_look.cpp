#include "init/draft_look.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/deadline.h"
#include "base/plain_text.h"
#include "base/rounding.h"
#include "base/units.h"
#include "fit/data/filter_check.h"
#include "fit/data/recording_check.h"
#include "fit/estimate/estimate.h"
#include "fit/estimate/recipes.h"
#include "init/free_choice.h"
#include "io/config/yaml_text.h"

namespace axisfit {
namespace {

/// Whether the values stay for most of the time, as those that somebody chose, or come in frames.
bool stays_in_steps(std::span<const double> values) {
  if (repetition_of(values) > 1) return true;
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

/// s, between samples.
double interval_of(const JobDraft& draft) {
  return sampling(draft.recordings.front().guess.time.values).interval;
}

/// T_d, free from here on.
DraftParameter free_delay(const JobDraft& draft, double delay) {
  const Quantity& quantity = draft.quantity("T_d").quantity;
  const double most =
      std::min(quantity.upper,
               round_to_digits(std::max(20.0 * interval_of(draft), 2.0 * std::abs(delay)), 2));
  return {"T_d", fmt::format(
                     "{{initial: {}, bounds: [{}, {}]}}", with_unit(round_to_digits(delay, 2), "s"),
                     with_unit(std::max(quantity.lower, -most), "s"), with_unit(most, "s"))};
}

/// One way in which the input may go from sample to sample, and what a short fit makes of it.
struct Timing {
  bool is_held = false;
  FirstLook::Term delay{};       ///< s, by which the motion then follows the input
  double chi_square = INFINITY;  ///< reduced; infinite without a fit

  /// With the wrong hold, a motion that is not late seems to be so by half a sample. Otherwise the
  /// smaller residual tells; thousands of samples make less than a hundredth by chance.
  bool is_better_than(const Timing& other, double interval) const {
    constexpr double kNone = 0.2, kHalf = 0.4, kClearly = 0.5, kBetter = 0.99;
    const auto needs_none = [=](const Timing& one, const Timing& with_half) {
      return std::abs(one.delay.value) < kNone * interval &&
             std::abs(with_half.delay.value) > kHalf * interval;
    };
    const double factor = needs_none(*this, other)   ? 1.0 / kClearly
                          : needs_none(other, *this) ? kClearly
                                                     : kBetter;
    return chi_square < factor * other.chi_square;
  }

  /// Whether there is a delay that hold and noise do not make.
  bool is_late(double interval) const {
    return std::abs(delay.value) >= std::max(0.5 * interval, FirstLook::kSure * delay.error);
  }
};

void set_hold(JobDraft& draft, bool is_held, const std::string& reason) {
  for (DraftRecording& recording : draft.recordings) {
    recording.is_held = is_held;
    recording.hold_reason = reason;
  }
}

/// With the delay of the first look. What is held acts half a sample later than what goes straight.
Timing seen_timing(const JobDraft& draft, bool is_held) {
  Timing timing{is_held, draft.look->delay};
  if (is_held) timing.delay.value -= 0.5 * interval_of(draft);
  return timing;
}

/// By a fit to the first samples of the recordings: enough for a time, and a matter of seconds.
Timing fitted_timing(JobDraft draft, bool is_held, const RunContext& context) {
  constexpr std::size_t kMostSamples = 20000;
  Timing timing = seen_timing(draft, is_held);
  set_hold(draft, is_held, " on trial");
  draft.parameters.push_back(free_delay(draft, timing.delay.value));
  for (DraftRecording& recording : draft.recordings) {
    const std::vector<double>& times = recording.guess.time.values;
    const std::size_t most = kMostSamples / draft.recordings.size();
    if (times.size() > most) recording.trim_to = times[most];
  }
  Job job = draft_job(draft);
  for (Recording& recording : job.recordings) recording.role = Role::fit;  // all of them tell
  job.options = recipe::quick(job.options);
  job.options.threads = 1;
  const FitResult fit = estimate(job, context);
  if (!fit.verdict.has_minimum()) return timing;
  timing.chi_square = fit.reduced_chi_square;
  const ParameterResult& found = fit.parameters.back();
  timing.delay = {found.value, found.uncertainty.standard_error};
  return timing;
}

/// By fits with both holds, unless they take longer than a hold is worth. Throws Interrupted after
/// a stop.
Timing best_timing(const JobDraft& draft, bool is_held, const RunContext& context) {
  constexpr double kSeconds = 0.5;  // of processors
  const Deadline deadline(context.stop, kSeconds);
  RunContext within = context.quiet();
  within.stop = deadline.flag();
  try {
    const Timing usual = fitted_timing(draft, is_held, within),
                 other = fitted_timing(draft, !is_held, within);
    return other.is_better_than(usual, interval_of(draft)) ? other : usual;
  } catch (const Interrupted&) {
    if (is_set(context.stop)) throw;
    return seen_timing(draft, is_held);
  }
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
  std::vector<std::vector<double>> inputs;
  for (const DraftRecording& recording : draft.recordings) inputs.push_back(recording.driving());
  std::vector<DrivenMotion> motions;
  for (std::size_t r = 0; r < inputs.size(); ++r)
    motions.push_back(driven_motion(draft.recordings[r].guess, inputs[r]));
  return first_look(motions, draft.structure.joint);
}

void correct_signs(JobDraft& draft) {
  draft.is_force_driven() ? correct_sign_of_force(draft) : correct_sign_of_velocity(draft);
}

void take_for_friction(JobDraft& draft) {
  if (!draft.look || draft.look->only_way == 0.0) return;
  FirstLook::Term &coulomb = draft.look->coulomb, &constant = draft.look->constant;
  draft.goes_one_way = draft.look->dissipation.value > 0.0;
  if (draft.goes_one_way) return;
  constant.value += draft.look->only_way * coulomb.value;
  coulomb.value = 0.0;
}

void set_timing(JobDraft& draft, const RunContext& context) {
  if (!draft.is_force_driven() || draft.joined) return;
  const bool is_stepped = std::ranges::any_of(draft.recordings, [](const DraftRecording& r) {
    return r.input_column().changes_only || stays_in_steps(r.input_column().values);
  });
  const bool is_held = draft.recordings.front().holds_input() || is_stepped;
  const auto take_hold = [&](bool held, const std::string& reason) {
    if (held != draft.recordings.front().holds_input()) set_hold(draft, held, reason);
  };
  take_hold(is_held, ": it stays in steps");
  if (!draft.look || draft.look->direction == FirstLook::Direction::open) return;
  Timing chosen = seen_timing(draft, is_held);
  try {
    chosen = best_timing(draft, is_held, context);
  } catch (const Interrupted&) {
    draft.guesses.emplace_back(
        "whether the input holds from sample to sample was not looked at, since the run was "
        "stopped");
  }
  take_hold(chosen.is_held, ": the motion goes better with it");
  const double interval = interval_of(draft);
  // A fit may take a delay for friction that the model lacks: the balance of forces must see it,
  // too.
  if (!chosen.is_late(interval) || !seen_timing(draft, chosen.is_held).is_late(interval)) return;
  draft.parameters.push_back(free_delay(draft, chosen.delay.value));
  const double late = 1e3 * std::abs(chosen.delay.value);
  const std::string column = sanitized(draft.recordings.front().input_column().column);
  draft.guesses.push_back(
      chosen.delay.value > 0.0
          ? fmt::format("T_d is free: the motion follows {} by {:.2g} ms, the lag of a drive or of "
                        "the motion's log",
                        column, late)
          : fmt::format("T_d is free: {} is logged {:.2g} ms late, probably by its filter", column,
                        late));
}

}  // namespace axisfit
