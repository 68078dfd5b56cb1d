#include "init/draft_look.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "fit/data/recording_check.h"

namespace axisfit {
namespace {

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

}  // namespace axisfit
