#include "init/init_job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/plain_text.h"
#include "fit/data/filter_check.h"
#include "fit/data/motion_check.h"
#include "init/busiest.h"
#include "init/draft_look.h"
#include "init/free_choice.h"
#include "init/input_choice.h"
#include "init/job_text.h"
#include "init/timing.h"
#include "io/config/axis_file.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

/// The axis file of the machine that was named, without the line for editors, which says where the
/// schema is.
void take_machine(JobDraft& draft) {
  const auto machine = std::ranges::find(machine_axes(), draft.request.axis, &MachineAxis::name);
  if (machine == machine_axes().end())
    throw std::runtime_error(fmt::format("there is no machine '{}': choose one of {}",
                                         sanitized(draft.request.axis),
                                         fmt::join(machine_names(), ", ")));
  std::string_view text = machine->text;
  if (text.starts_with("# yaml-language-server")) text.remove_prefix(text.find('\n') + 1);
  draft.axis_text = text;
}

/// Of the axis that was named.
void read_structure(JobDraft& draft) {
  Diagnostics diagnostics;
  if (draft.request.is_machine) take_machine(draft);
  const auto rig =
      draft.request.is_machine
          ? read_axis(*ConfigNode::parse(draft.axis_text, kAxisName, diagnostics), diagnostics)
          : read_axis_file(draft.request.axis, diagnostics);
  diagnostics.throw_if_any();
  draft.structure = rig->model.structure;
}

std::vector<std::string> names_of(const DraftRecording& recording) {
  std::vector<std::string> names;
  if (recording.guess.rate == 0.0) names.push_back(recording.guess.time.column);
  for (const GuessedColumn& c : recording.guess.columns) names.push_back(c.column);
  for (const std::string& name : recording.guess.unused)
    names.push_back(name + (std::ranges::count(recording.guess.constant, name) > 0
                                ? " (never changes)"
                                : " (not recognised)"));
  for (std::string& name : names) name = sanitized(name);
  return names;
}

void add(JobDraft& draft, const std::string& path, RecordingGuess guess) {
  DraftRecording recording{
      fs::path(path).stem().string(), draft.relative(path), std::move(guess), {}};
  for (int n = 2; std::ranges::count(draft.recordings, recording.name, &DraftRecording::name) > 0;
       ++n)
    recording.name = fmt::format("{}-{}", fs::path(path).stem().string(), n);
  draft.recordings.push_back(std::move(recording));
}

/// Of one axis, that which the first shows, and in the same units: what one recording says only by
/// how large its values are, the largest of all recordings tell.
std::vector<RecordingGuess> guesses_of(const JobDraft& draft) {
  const std::vector<std::string>& paths = draft.request.recordings;
  std::vector<RecordingFile> files;
  GuessOptions options{draft.request.answers, draft.structure.joint, {}};
  std::vector<RecordingGuess> guesses;
  const auto guess_all = [&] {
    guesses.clear();
    for (std::size_t i = 0; i < paths.size(); ++i) {
      guesses.push_back(guess_recording(files[i], paths[i], options));
      if (const std::string& motor = guesses.front().motor; !motor.empty() && i == 0)
        options.answers.motor = motor;
    }
  };
  for (const std::string& path : paths) files.emplace_back(path);
  guess_all();
  bool is_open = false;
  for (const RecordingGuess& guess : guesses)
    for (const GuessedColumn& column : guess.columns) {
      double& most = options.ranges[column.column];
      most = std::max(most, column.range);
      is_open = is_open || column.sized_by_range;
    }
  const std::vector<std::string> notes = guesses.front().notes;
  if (is_open && paths.size() > 1) guess_all();
  guesses.front().notes = notes;
  return guesses;
}

/// Every answer is about a column that is there.
void check_answers(const JobDraft& draft) {
  for (const ColumnAnswer& answer : draft.request.answers.columns) {
    const auto found = [&](const GuessedColumn& c) { return c.answer == answer.column; };
    if (std::ranges::none_of(draft.recordings, [&](const DraftRecording& s) {
          return found(s.guess.time) || std::ranges::any_of(s.guess.columns, found);
        }))
      throw std::runtime_error(
          fmt::format("--column: no recording has a column '{}'; those of {} are {}",
                      sanitized(answer.column), sanitized(draft.recordings.front().guess.path),
                      fmt::join(names_of(draft.recordings.front()), ", ")));
  }
}

/// By what the first recording has of a kind that only one drive makes.
void choose_drive(JobDraft& draft) {
  const RecordingGuess& first = draft.recordings.front().guess;
  const bool loop = is_of_velocity_loop(first);
  draft.structure.drive = loop ? Drive::velocity_loop : Drive::force_source;
  draft.structure.transmission = loop ? Transmission::backlash : Transmission::rigid;
  if (!loop && is_of_angles(first)) draft.structure.joint = Joint::revolute;
}

bool has_measured(const JobDraft& draft, const DraftRecording& recording) {
  return std::ranges::any_of(recording.guess.columns, [&](const GuessedColumn& c) {
    return draft.is_measured(c) && &c != &recording.input_column();
  });
}

void drop_recordings_without_input(JobDraft& draft) {
  std::vector<std::string> unusable;
  std::erase_if(draft.recordings, [&](const DraftRecording& recording) {
    const bool driven = recording.input.has_value();
    if (driven && has_measured(draft, recording)) return false;
    unusable.push_back(sanitized(fmt::format(
        "{}: no column {}; the columns are {}. If one of them does, say so by --column {}; "
        "otherwise record that signal.",
        recording.guess.path, driven ? "shows how the axis moved" : "shows what drove the axis",
        fmt::join(names_of(recording), ", "),
        driven                    ? "position=COLUMN:mm or velocity=COLUMN:m/s"
        : draft.is_force_driven() ? "current=COLUMN:A, force=COLUMN:N or command=COLUMN:V"
                                  : "command=COLUMN:V")));
    return true;
  });
  if (draft.recordings.empty())
    throw std::runtime_error(fmt::format("{}", fmt::join(unusable, "\n")));
  for (const std::string& text : unusable) draft.guesses.push_back("Skipped: " + text);
}

/// What was measured and arrives in frames: each value counts once, at its time, and `values` get
/// the curve between them.
void find_frames(JobDraft& draft) {
  for (DraftRecording& recording : draft.recordings)
    for (GuessedColumn& c : recording.guess.columns) {
      if (!draft.is_measured(c) || &c == &recording.input_column() || !c.clock.empty()) continue;
      c.hold = repetition_of(c.values);
      if (c.hold == 1) continue;
      Measurement frames;
      frames.values = std::move(c.values);
      frames.hold = c.hold;
      exclude_uninformative(frames);
      c.values = std::move(frames.values);
      c.reasons.push_back(fmt::format("each value is recorded {} times", c.hold));
    }
}

/// A motion that ends on a hard stop is used until then.
void leave_out_stops(JobDraft& draft) {
  for (DraftRecording& recording : draft.recordings) {
    Recording motion;
    motion.times = recording.guess.time.values;
    for (const Signal signal : {Signal::position, Signal::velocity}) {
      const GuessedColumn* column =
          recording.guess.find(signal == Signal::position ? Kind::position : Kind::velocity);
      if (column == nullptr) continue;
      Measurement& m = motion.measurements.emplace_back();
      m.signal = signal;
      m.values = column->values;
    }
    const auto stop = hard_stop(motion, recording.driving());
    if (!stop) continue;
    const auto used = static_cast<std::size_t>(
        std::ranges::upper_bound(motion.times, stop->last_before) - motion.times.begin());
    constexpr std::size_t kFewest = 50;
    if (used < kFewest) continue;
    recording.trim_to = stop->last_before;
    recording.keep_samples(0, used);
    draft.guesses.push_back(
        fmt::format("{} ends on a hard stop at {:.4g} s: it is used up to {:.4g} s", recording.name,
                    stop->at, stop->last_before));
  }
}

/// The axis file that is missing.
void start_axis(JobDraft& draft) {
  const DraftRecording& first = draft.recordings.front();
  if (draft.request.gain && (!draft.is_force_driven() || first.drives_in_newtons()))
    throw std::runtime_error(fmt::format(
        "--gain is the {} per unit of a current or command, but {} is {}: leave it out",
        draft.say("force"), first.input_column().title(),
        draft.is_force_driven() ? draft.say("a force") : "a velocity that is asked for"));
  if (!draft.is_force_driven()) {
    draft.starter = velocity_loop_starter(first.file);
    draft.axis_text = draft.starter->text;
    draft.guesses.push_back(
        "axis.yaml describes a velocity loop with the values of a published axis");
    return;
  }
  DrivenMass seen;
  seen.column = first.input_column().title();
  seen.is_force = first.drives_in_newtons();
  double speed = 0.0;
  for (const DraftRecording& recording : draft.recordings) {
    seen.largest_input = std::max(seen.largest_input, largest(recording.driving()));
    if (const GuessedColumn* velocity = recording.guess.find(Kind::velocity))
      speed = std::max(speed, largest(velocity->values));
  }
  if (speed > 0.0) seen.largest_speed = speed;
  seen.look = draft.look;
  seen.gain = draft.request.gain;
  seen.structure = draft.structure;
  draft.starter = mass_starter(first.file, seen);
  draft.structure = draft.starter->structure;
  draft.axis_text = draft.starter->text;
  if (draft.starter->gain_guessed)
    draft.guesses.push_back(
        fmt::format("the drive gain, K_f in axis.yaml: {}, B_a and the friction {} scale with it",
                    draft.quantity("M").name, draft.say("forces")));
}

/// For the user's eye, what the files mark: a column of several recordings once.
void collect_guesses(JobDraft& draft) {
  std::set<std::string> seen, unused;
  for (const DraftRecording& recording : draft.recordings) {
    for (const std::string& note : recording.guess.notes) draft.guesses.push_back(sanitized(note));
    for (const std::string& name : recording.guess.unused)
      if (std::ranges::count(recording.guess.constant, name) == 0)
        unused.insert(sanitized(shortened(name)));
    const auto list_guess = [&](const GuessedColumn& c) {
      if (!c.guessed) return;
      if (seen.insert(c.column).second)
        draft.guesses.push_back(
            sanitized(fmt::format("{}: {}", c.title(), fmt::join(c.reasons, "; "))));
    };
    list_guess(recording.guess.time);
    for (const GuessedColumn& c : recording.guess.columns)
      if (draft.is_measured(c) || c.contradicts || &c == &recording.input_column())
        list_guess(c);
      else if (!c.idle && c.kind != Kind::supply)
        unused.insert(c.title());
    for (const std::string& name : recording.guess.constant)
      if (seen.insert(name).second)
        draft.guesses.push_back(sanitized(name + ": not used, for it never changes"));
  }
  if (!unused.empty())
    draft.guesses.push_back(fmt::format("not used: {}", fmt::join(unused, ", ")));
}

}  // namespace

InitialJob initial_job(const InitRequest& request, const RunContext& context) {
  JobDraft draft{request};
  const std::vector<std::string>& recordings = request.recordings;
  const bool makes_axis = request.axis.empty();
  if (!makes_axis) read_structure(draft);
  for (auto path = recordings.begin(); path != recordings.end(); ++path) {
    std::error_code ignored;
    if (std::any_of(recordings.begin(), path, [&](const std::string& earlier) {
          return fs::equivalent(earlier, *path, ignored);
        }))
      throw std::runtime_error(
          fmt::format("{} is given twice: a recording counts once", sanitized(*path)));
  }
  context.report({.phase = "reading the recordings"});
  std::vector<RecordingGuess> guesses = guesses_of(draft);
  for (std::size_t i = 0; i < recordings.size(); ++i)
    add(draft, recordings[i], std::move(guesses[i]));
  check_answers(draft);
  join_files(draft);
  if (makes_axis) choose_drive(draft);
  for (DraftRecording& recording : draft.recordings)
    write_units(recording.guess, draft.vocabulary());
  choose_inputs(draft);
  drop_recordings_without_input(draft);
  refuse_unrelated(draft);
  find_frames(draft);
  leave_out_stops(draft);
  if (request.is_on_trial) keep_busiest(draft, kEnoughSamples);
  context.report({.phase = "a first look at the forces"});
  draft.look = look_at(draft);
  correct_signs(draft);
  drop_idle_velocities(draft);
  use_common_signals(draft);
  if (makes_axis) {
    take_for_friction(draft);
    start_axis(draft);
  }
  list_parameters(draft);
  context.report({.phase = "what the recordings determine"});
  choose_free(draft, context.stop);
  context.report({.phase = "how the input goes from sample to sample"});
  if (makes_axis || request.is_machine) set_timing(draft, context);
  collect_guesses(draft);
  return {job_files(draft), std::move(draft.guesses), draft.look};
}

std::vector<std::string> machines_for(const InitRequest& request) {
  std::vector<std::string> names;
  const std::string& path = request.recordings.front();
  const RecordingGuess first = guess_recording(RecordingFile(path), path, {request.answers});
  if (is_of_velocity_loop(first)) return names;
  const auto input = std::ranges::find_if(
      force_inputs(), [&](const InputColumn& i) { return has_changing_input(first, i); });
  const auto is_driven_by = [&](const Capabilities& has) {
    if (has.is_electric) return first.find(Kind::set_velocity) || first.find(Kind::velocity, true);
    if (has.has_back_emf) {
      // What a servo reports beside its goal is its duty, or some other measure of how hard it
      // pulls.
      const bool has_force = input != force_inputs().end() && input->kind != Kind::command;
      return first.find(Kind::motor_voltage) != nullptr || (!has_force && voltage_input(first));
    }
    if (input == force_inputs().end() || !has.is_force_driven) return false;
    if (first.find(input->kind, input->is_setpoint)->of_rating)
      return has.command == Command::share_of_rated;
    return input->kind == Kind::current && has.command == Command::current;
  };
  for (const MachineAxis& machine : machine_axes()) {
    Diagnostics diagnostics;
    const auto rig =
        read_axis(*ConfigNode::parse(std::string(machine.text), "", diagnostics), diagnostics);
    const Structure& structure = rig->model.structure;
    const bool moves_so = has_motion_without_unit(first) ||
                          (structure.joint == Joint::revolute) == is_of_angles(first);
    if (moves_so && is_driven_by(capabilities(structure))) names.emplace_back(machine.name);
  }
  return names;
}

}  // namespace axisfit
