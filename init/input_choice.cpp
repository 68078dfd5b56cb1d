#include "init/input_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/plain_text.h"
#include "fit/data/noise.h"
#include "fit/data/recording_check.h"
#include "init/columns/resample.h"
#include "init/draft_look.h"

namespace axisfit {
namespace {

/// What a velocity loop is driven by. A position that is asked for counts only where the controller
/// is known, which makes the command of it.
std::optional<InputColumn> velocity_input(const RecordingGuess& recording, bool known_controller) {
  for (const Kind kind : {Kind::set_velocity, Kind::command})
    if (recording.find(kind)) return InputColumn{"command", kind};
  if (recording.find(Kind::velocity, true))
    return InputColumn{"command", Kind::velocity, true, ControllerGains<double>().gain};
  if (known_controller && recording.find(Kind::position, true) && recording.find(Kind::position))
    return InputColumn{"position_reference", Kind::position, true};
  return std::nullopt;
}

bool moves(const RecordingGuess& recording) {
  return recording.find(Kind::position) || recording.find(Kind::velocity) ||
         recording.find(Kind::acceleration);
}

bool has_input(const RecordingGuess& recording, const InputColumn& input) {
  return recording.find(input.kind, input.is_setpoint) != nullptr;
}

/// What is added to the clock of the input for the motion to follow it.
double best_offset(const DraftRecording& motion, const std::vector<double>& clock,
                   const std::vector<double>& values) {
  const std::vector<double>& times = motion.guess.time.values;
  double offset = times.front() - clock.front(), least = INFINITY;
  const auto look_at = [&](double from, double reach) {
    const std::vector<double> input = held_at(times, clock, values, from);
    const DrivenMotion driven = driven_motion(motion.guess, input);
    const auto found =
        first_look(std::span(&driven, 1),
                   {.least_delay = -reach, .longest_delay = reach, .by_evidence = true});
    if (!found || !(found->unexplained < least)) return;
    least = found->unexplained;
    offset = from + found->delay.value;
  };
  // As if both had begun together, and from there half of the shorter one to either side.
  constexpr int kLooks = 12;
  const double step =
      0.5 * std::min(times.back() - times.front(), clock.back() - clock.front()) / kLooks;
  const double begin = offset;
  for (int k = -kLooks; k <= kLooks; ++k) look_at(begin + k * step, 0.6 * step);
  for (const double reach : {0.2 * step, 0.02 * step}) {
    least = INFINITY;
    look_at(offset, reach);
  }
  return offset;
}

/// The job takes a part of a rating as it is, where the drive does.
void write_rating(const JobDraft& draft, DraftRecording& recording) {
  if (!recording.input || !recording.input_column().of_rating || draft.command_unit() != "1")
    return;
  GuessedColumn& input = recording.input_column();
  constexpr double kPercent = 0.01;
  input.unit = std::string("%");  // of a char array g++ 12 warns without reason
  for (double& x : input.values) x *= kPercent;
  std::erase_if(input.reasons, [](const std::string& r) { return r.starts_with(kInPercent); });
  input.guessed = false;
}

/// By how much the velocity comes behind the derivative of the position, s, where it clearly does
/// by two samples or more; or else zero.
double lateness(const RecordingGuess& recording) {
  const GuessedColumn *position = recording.find(Kind::position),
                      *velocity = recording.find(Kind::velocity);
  constexpr std::size_t kMost = 20;
  const std::size_t n = recording.time.values.size();
  if (position == nullptr || velocity == nullptr || n < 10 * kMost) return 0.0;
  /// The part of the velocity that is not that derivative, so many samples before.
  const auto unlike = [&](std::size_t samples) {
    const auto found = rate_ratio(std::span(recording.time.values).first(n - samples),
                                  std::span(position->values).first(n - samples),
                                  std::span(velocity->values).last(n - samples));
    return found ? 1.0 - found->correlation * std::abs(found->correlation) : 1.0;
  };
  std::size_t best = 0;
  double least = unlike(0);
  const double now = least;
  for (std::size_t samples = 1; samples <= kMost; ++samples)
    if (const double left = unlike(samples); left < least) {
      least = left;
      best = samples;
    }
  constexpr double kClear = 0.5;
  constexpr double kMatters = 1e-3;  // of the velocity's mean square: less is what digits leave
  return best >= 2 && now > kMatters && least < kClear * now
             ? static_cast<double>(best) * sampling(recording.time.values).interval
             : 0.0;
}

/// Whether the velocity says less than the position, over the time in which an observer follows
/// them: then the simulation would follow its noise. Drives often compute it from the position.
bool is_velocity_idle(const RecordingGuess& recording, const std::vector<double>& input) {
  const GuessedColumn *position = recording.find(Kind::position),
                      *velocity = recording.find(Kind::velocity);
  if (position == nullptr || velocity == nullptr) return false;
  const double rate =
      suggested_observer_gain(recording.time.values, position->values, {}, input, 0.0).rate;
  // The slope of a line through the positions of that time, beside the mean of the velocities.
  constexpr double kSlope = 3.46, kClear = 2.0;
  const double noise =
      std::max(noise_from_differences(position->values), resolution_of(position->values) / kSlope);
  return noise_from_differences(velocity->values) > kClear * kSlope * noise * rate;
}

/// Whether the speed changes by half of its mean or more. At one speed a mass explains nothing:
/// what is left is ripple.
bool changes_speed(const RecordingGuess& recording) {
  const GuessedColumn* position = recording.find(Kind::position);
  if (position == nullptr) position = recording.find(Kind::velocity);
  if (position == nullptr) return false;
  constexpr std::size_t kStretches = 50;
  const std::size_t n = position->values.size();
  if (n < 4 * kStretches) return false;
  std::vector<double> speeds;
  for (std::size_t k = 0; k < kStretches; ++k) {
    const std::size_t a = k * (n - 1) / kStretches, b = (k + 1) * (n - 1) / kStretches;
    speeds.push_back(position->kind == Kind::velocity
                         ? position->values[a]
                         : (position->values[b] - position->values[a]) /
                               (recording.time.values[b] - recording.time.values[a]));
  }
  double mean = 0.0;
  for (const double v : speeds) mean += v / double(kStretches);
  constexpr double kChange = 0.5;
  return standard_deviation(speeds) > kChange * std::abs(mean);
}

/// The part of what drives a recording, about its mean, that a mass with friction explains. Nothing
/// where that cannot be told.
std::optional<double> explained_part(const DraftRecording& recording) {
  if (!changes_speed(recording.guess)) return std::nullopt;
  std::vector<double> input = recording.driving();
  double mean = 0.0;
  for (const double x : input) mean += x / static_cast<double>(input.size());
  for (double& x : input) x -= mean;
  const DrivenMotion motion = driven_motion(recording.guess, input);
  const auto look = first_look(std::span(&motion, 1));
  if (!look) return std::nullopt;
  return look->shows_anything() ? look->explained() : 0.0;
}

bool is_answered(const DraftRecording& recording) {
  const GuessedColumn *position = recording.guess.find(Kind::position),
                      *velocity = recording.guess.find(Kind::velocity);
  const GuessedColumn* motion = position ? position : velocity;
  return !recording.input_column().answer.empty() && motion && !motion->answer.empty();
}

}  // namespace

const std::vector<InputColumn>& force_inputs() {
  static const std::vector<InputColumn> list{
      {"drive_force", Kind::force, false},   {"drive_force", Kind::force, true},
      {"command", Kind::current, false},     {"command", Kind::current, true},
      {"command", Kind::command, false},     {"command", Kind::motor_voltage, false},
      {"command", Kind::set_velocity, false}};
  return list;
}

std::optional<InputColumn> voltage_input(const RecordingGuess& recording) {
  if (recording.find(Kind::motor_voltage)) return InputColumn{"command", Kind::motor_voltage};
  if (recording.find(Kind::position, true) && recording.find(Kind::position))
    return InputColumn{"position_reference", Kind::position, true};
  if (recording.find(Kind::command)) return InputColumn{"command", Kind::command};
  return std::nullopt;
}

bool has_changing_input(const RecordingGuess& recording, const InputColumn& input) {
  const GuessedColumn* column = recording.find(input.kind, input.is_setpoint);
  return column != nullptr && !column->is_constant();
}

bool is_of_velocity_loop(const RecordingGuess& recording) {
  return velocity_input(recording, false) &&
         (recording.find(Kind::tachometer) || recording.find(Kind::preamplifier_voltage) ||
          std::ranges::none_of(force_inputs(), [&](const InputColumn& input) {
            return input.kind != Kind::set_velocity && has_input(recording, input);
          }));
}

void join_files(JobDraft& draft) {
  if (draft.recordings.size() != 2) return;
  const auto driver = std::ranges::find_if(draft.recordings, [](const DraftRecording& s) {
    return !moves(s.guess) && std::ranges::any_of(force_inputs(), [&](const InputColumn& input) {
      return has_input(s.guess, input);
    });
  });
  const auto motion = std::ranges::find_if(draft.recordings, [](const DraftRecording& s) {
    return moves(s.guess) && std::ranges::none_of(force_inputs(), [&](const InputColumn& input) {
             return has_input(s.guess, input);
           });
  });
  if (driver == draft.recordings.end() || motion == draft.recordings.end()) return;
  const auto input = std::ranges::find_if(
      force_inputs(), [&](const InputColumn& i) { return has_input(driver->guess, i); });
  GuessedColumn column = *driver->guess.find(input->kind, input->is_setpoint);
  const GuessedColumn& clock = driver->guess.time;
  const double offset = best_offset(*motion, clock.values, column.values);
  motion->input_file = driver->file;
  motion->input_offset = offset;
  column.clock = clock.column;
  column.clock_unit = clock.unit;
  column.values = held_at(motion->guess.time.values, clock.values, column.values, offset);
  column.reasons.push_back(
      fmt::format("from {}, whose clock was set {:.6g} s {}: there the force goes best with the "
                  "acceleration; the delay T_d, which is free, does the rest",
                  driver->name, std::abs(offset), offset < 0.0 ? "back" : "forward"));
  column.guessed = true;
  motion->guess.columns.push_back(std::move(column));
  draft.joined = true;
  draft.recordings.erase(driver);
}

void choose_inputs(JobDraft& draft) {
  if (!draft.is_force_driven()) {
    for (DraftRecording& recording : draft.recordings) {
      recording.input = capabilities(draft.structure).has_back_emf
                            ? voltage_input(recording.guess)
                            : velocity_input(recording.guess, !draft.request.axis.empty());
      if (!recording.input || recording.input->kind != Kind::velocity) continue;
      GuessedColumn& column = *recording.guess.find(Kind::velocity, true);
      column.reasons.push_back(fmt::format("a set velocity, taken as a command of {:g} V per m/s",
                                           recording.input->gain));
      column.guessed = true;
    }
    return;
  }
  const auto of_all = [&](auto&& has) {
    return std::ranges::find_if(force_inputs(), [&](const InputColumn& input) {
      return std::ranges::all_of(draft.recordings,
                                 [&](const DraftRecording& s) { return has(s.guess, input); });
    });
  };
  auto chosen = of_all(has_changing_input);
  if (chosen == force_inputs().end()) chosen = of_all(has_input);
  if (chosen == force_inputs().end())
    chosen = std::ranges::find_if(force_inputs(), [&](const InputColumn& input) {
      return has_input(draft.recordings.front().guess, input);
    });
  for (DraftRecording& recording : draft.recordings)
    if (chosen != force_inputs().end() && has_input(recording.guess, *chosen)) {
      recording.input = *chosen;
      // A part of a rating is a force only once K_f says how large.
      if (recording.input_column().of_rating) recording.input->key = "command";
    }
  if (draft.request.axis.empty() && chosen != force_inputs().end() &&
      draft.recordings.front().input) {
    if (draft.recordings.front().input_column().of_rating)
      draft.structure.drive = Drive::rated_force;
    else if (chosen->kind == Kind::current)
      draft.structure.drive = Drive::motor_current;
  }
  for (DraftRecording& recording : draft.recordings) write_rating(draft, recording);
}

void drop_idle_velocities(JobDraft& draft) {
  std::string reason;
  const auto of_each = [&](auto&& use) {
    for (DraftRecording& recording : draft.recordings) {
      GuessedColumn* velocity = recording.guess.find(Kind::velocity);
      if (velocity != nullptr && velocity != &recording.input_column()) use(recording, *velocity);
    }
  };
  of_each([&](const DraftRecording& recording, GuessedColumn&) {
    if (!reason.empty()) return;
    const std::string in =
        draft.recordings.size() > 1 ? fmt::format(" in {}", recording.name) : std::string();
    // The simulation of a direct drive follows the recording.
    if (const double late = lateness(recording.guess); late > 0.0)
      reason = fmt::format(
          "not used: it comes {:.2g} ms behind the derivative of the position{}, "
          "as one that a filter has smoothed",
          1e3 * late, in);
    else if (draft.is_direct() &&
             is_velocity_idle(recording.guess, recording.input_column().values))
      reason = fmt::format("not used: the position tells the same more precisely{}", in);
  });
  if (reason.empty()) return;
  // What is fitted and what validates are compared with the same signals.
  of_each([&](DraftRecording& recording, GuessedColumn& velocity) {
    if (recording.guess.find(Kind::position) == nullptr) return;
    velocity.idle = true;
    velocity.reasons.push_back(reason);
  });
}

void use_common_signals(JobDraft& draft) {
  const auto measured = [&](DraftRecording& recording, const GuessedColumn& like) {
    GuessedColumn* column = recording.guess.find(like.kind, like.is_setpoint);
    return column && column != &recording.input_column() && draft.is_measured(*column) ? column
                                                                                       : nullptr;
  };
  const auto first_without = [&](const GuessedColumn& like) {
    return std::ranges::find_if(draft.recordings, [&](DraftRecording& recording) {
      return measured(recording, like) == nullptr;
    });
  };
  std::vector<std::pair<GuessedColumn*, std::string>> partial;
  bool any_common = false;
  for (DraftRecording& recording : draft.recordings)
    for (GuessedColumn& column : recording.guess.columns) {
      if (measured(recording, column) != &column) continue;
      const auto without = first_without(column);
      if (without == draft.recordings.end())
        any_common = true;
      else
        partial.emplace_back(&column, without->name);
    }
  if (!any_common) return;
  for (auto& [column, name] : partial) {
    column->idle = true;
    column->reasons.push_back(fmt::format("not used: {} has none to compare with", name));
  }
}

void refuse_unrelated(const JobDraft& draft) {
  if (!draft.is_force_driven()) return;
  // Of what drives an axis a third is explained even where most of it holds a load or overcomes
  // what nobody knows; and friction or mass show.
  constexpr double kLeast = 0.2;
  double most = 0.0;
  for (const DraftRecording& recording : draft.recordings) {
    if (is_answered(recording)) return;
    const auto part = explained_part(recording);
    if (!part) return;
    most = std::max(most, *part);
  }
  if (most >= kLeast || draft.recordings.empty()) return;
  const DraftRecording& first = draft.recordings.front();
  const GuessedColumn* motion = first.guess.find(Kind::position);
  if (motion == nullptr) motion = first.guess.find(Kind::velocity);
  throw std::runtime_error(sanitized(fmt::format(
      "{}: {} explains nothing of how {} moves (correlation {:.2f}): they are hardly of the same "
      "axis. If they are, say so by --column, once for each; otherwise name the right columns by "
      "it",
      first.guess.path, first.input_column().column, motion ? motion->column : "the axis", most)));
}

}  // namespace axisfit
