#include "init/job_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "base/rounding.h"
#include "base/units.h"
#include "base/version.h"
#include "fit/data/noise.h"
#include "fit/data/recording_check.h"
#include "io/config/yaml_text.h"

namespace axisfit {
namespace {

/// The line by which editors find the schema that the Debian package installs.
std::string modeline(std::string_view kind) {
  return fmt::format("# yaml-language-server: $schema=/usr/share/axisfit/schema/{}.schema.json\n",
                     kind);
}

std::string scalar(const std::string& text) {
  YAML::Emitter out;
  out << text;
  return out.c_str();
}

/// "{column: time_s, unit: s}"
std::string column_map(const GuessedColumn& column, const std::string& unit,
                       const std::pair<std::string, std::string>& more = {},
                       const std::string& file = {}, double offset = 0.0) {
  YAML::Emitter out;
  out << YAML::Flow << YAML::BeginMap << YAML::Key << "column" << YAML::Value << column.column
      << YAML::Key << "unit" << YAML::Value << unit;
  if (column.factor != 1.0)
    out << YAML::Key << "factor" << YAML::Value << fmt::format("{:.10g}", column.factor);
  if (column.overflow.signed_bits > 0)
    out << YAML::Key << "signed_bits" << YAML::Value << column.overflow.signed_bits;
  if (column.overflow.wraps_after > 0.0)
    out << YAML::Key << "wraps_after" << YAML::Value
        << fmt::format("{:.15g}", column.overflow.wraps_after);
  if (column.negative) out << YAML::Key << "sign" << YAML::Value << "-1";
  if (!file.empty()) out << YAML::Key << "file" << YAML::Value << file;
  if (!column.clock.empty())
    out << YAML::Key << "time" << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key
        << "column" << YAML::Value << column.clock << YAML::Key << "unit" << YAML::Value
        << column.clock_unit << YAML::EndMap;
  if (!column.supply.empty())
    out << YAML::Key << "supply" << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key
        << "column" << YAML::Value << column.supply << YAML::Key << "unit" << YAML::Value
        << column.supply_unit << YAML::EndMap;
  if (column.hold > 1) out << YAML::Key << "hold" << YAML::Value << column.hold;
  if (column.averaged > 1)
    out << YAML::Key << "filter" << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key
        << "moving_average" << YAML::Value << column.averaged << YAML::EndMap;
  if (offset != 0.0)
    out << YAML::Key << "offset" << YAML::Value << with_unit(round_to_digits(offset, 6), "s");
  if (!more.first.empty()) out << YAML::Key << more.first << YAML::Value << more.second;
  out << YAML::EndMap;
  return out.c_str();
}

std::string reasons_text(const GuessedColumn& column, std::size_t indent) {
  if (column.reasons.empty()) return {};
  return comment(
      fmt::format("{}{}.", column.guessed ? kGuessed : "", fmt::join(column.reasons, "; ")),
      indent);
}

std::string_view name_of(const JobDraft& draft, Kind kind) {
  return info(*signal_of(kind), draft.vocabulary()).name;
}

/// Whether all recordings have channels of the same names: a job needs them in each.
bool have_same_channels(const JobDraft& draft) {
  const auto names = [](const DraftRecording& recording) {
    std::vector<std::string> list;
    for (const GuessedChannel& c : recording.guess.channels) list.push_back(c.guess.name);
    std::ranges::sort(list);
    return list;
  };
  return std::ranges::all_of(draft.recordings, [&](const DraftRecording& s) {
    return names(s) == names(draft.recordings.front());
  });
}

/// What may act on the axis, for --close-loop to try; else it is not used.
std::string channels_text(const JobDraft& draft, const std::vector<GuessedChannel>& channels,
                          std::vector<std::string>& unused) {
  if (channels.empty()) return {};
  if (!have_same_channels(draft)) {
    for (const GuessedChannel& c : channels) unused.push_back(c.column);
    return {};
  }
  std::string text = comment("These may act on the axis: --close-loop tries them as causes.", 4) +
                     "    channels:\n";
  for (const GuessedChannel& c : channels) {
    GuessedColumn column;
    column.column = c.column;
    text += fmt::format("      {}: {}\n", c.guess.name, column_map(column, c.guess.unit));
  }
  return text;
}

std::string input_text(const JobDraft& draft, const DraftRecording& recording,
                       const GuessedColumn& input) {
  GuessedColumn written = input;
  written.factor *= recording.input->gain;
  std::string unit = input.unit;
  const std::string_view taken = draft.command_unit();
  const bool is_of_supply = !input.supply.empty() && taken == "V";
  if (!is_of_supply) written.supply.clear();
  if (!is_of_supply && recording.input->key == std::string_view("command") &&
      !std::holds_alternative<double>(unit_factor(unit, taken))) {
    // The job's command is in the unit of the drive, whatever was recorded.
    const auto factor = unit_factor(unit, unit_on(draft.vocabulary(), si_unit(input.kind)));
    written.factor *= std::get<double>(factor);
    unit = taken;
    if (recording.input->kind != Kind::velocity)
      written.reasons.push_back(fmt::format(
          "the command of the axis; the job treats it as {}, whatever its unit, and K_f as {}",
          taken, draft.quantity("K_f").quantity.unit));
  }
  std::pair<std::string, std::string> hold;
  const bool in_newtons = recording.drives_in_newtons(), is_linear = !recording.holds_input();
  if (is_linear != in_newtons)  // else the default of the key
    hold = {"hold", is_linear ? "linear" : "zero_order"};
  if (!hold.first.empty() || !recording.hold_reason.empty())
    written.reasons.push_back(std::string(is_linear ? "it goes straight from one sample to the next"
                                                    : "each value holds until the next") +
                              (!recording.hold_reason.empty() ? recording.hold_reason
                               : is_linear                    ? ", as what is measured does"
                                                              : ", as what is commanded does"));
  return reasons_text(written, 6) +
         fmt::format("      {}: {}\n", draft.say(recording.input->key),
                     column_map(written, unit, hold, recording.input_file, recording.input_offset));
}

/// Whether the first value of a velocity is none, and the next ones are hardly more.
bool begins_at_rest(const GuessedColumn& velocity) {
  constexpr double kErrors = 4.0, kPart = 0.02;
  const double first = std::abs(velocity.values.front());
  return first <= kPart * largest(velocity.values) &&
         first <= kErrors * std::max(noise_from_differences(velocity.values),
                                     resolution_of(velocity.values));
}

/// A recording that begins at rest needs no more than where; another one its first samples.
std::string initial_text(const JobDraft& draft, const RecordingGuess& guess) {
  const GuessedColumn *position = guess.find(Kind::position),
                      *velocity = guess.find(Kind::velocity);
  if (position == nullptr && velocity == nullptr) return {};
  if (draft.is_direct())
    return std::string("    initial_state: data   # from the first samples\n") +
           (velocity && begins_at_rest(*velocity)
                ? fmt::format("    set: {{initial.y1: {}}}   # at rest, by its velocity\n",
                              with_unit(0.0, unit_on(draft.vocabulary(), "m/s")))
                : "");
  constexpr std::size_t kFirst = 4;
  double speed = 0.0, noise = 0.0;
  if (velocity) {
    for (std::size_t i = 0; i < kFirst; ++i) speed += velocity->values[i] / double(kFirst);
    noise = noise_from_differences(velocity->values);
  } else {
    const auto& t = guess.time.values;
    speed = (position->values[kFirst] - position->values[0]) / (t[kFirst] - t[0]);
    noise = std::max(noise_from_differences(position->values), resolution_of(position->values)) /
            (t[kFirst] - t[0]);
  }
  if (std::abs(speed) > 5.0 * noise + 1e-9)
    return "    initial_state: data   # from the first samples: the axis is already moving\n";
  if (position == nullptr || position->values.front() == 0.0) return {};
  return fmt::format("    set: {{initial.y0: {}}}   # it starts at rest at this position\n",
                     with_unit(position->values.front(), unit_on(draft.vocabulary(), "m")));
}

std::string recording_text(const JobDraft& draft, const DraftRecording& recording, bool validates) {
  const RecordingGuess& guess = recording.guess;
  std::string text =
      fmt::format("  - name: {}\n    file: {}\n", scalar(recording.name), scalar(recording.file));
  text += validates ? "    role: validate   # not fitted: validates the fit\n" : "    role: fit\n";
  text += initial_text(draft, guess);
  const Sampling found = sampling(guess.time.values);
  text += reasons_text(guess.time, 4);
  text += guess.rate > 0.0
              ? fmt::format("    rate: {:.10g} Hz   # {:.4g} s\n", guess.rate, found.duration)
              : fmt::format("    time: {}   # {:.4g} Hz, {:.4g} s\n",
                            column_map(guess.time, guess.time.unit), 1.0 / found.interval,
                            found.duration);
  std::vector<std::string> trim;
  if (recording.trim_from) trim.push_back("from: " + with_unit(*recording.trim_from, "s"));
  if (recording.trim_to) trim.push_back("to: " + with_unit(*recording.trim_to, "s"));
  if (!trim.empty()) text += fmt::format("    trim: {{{}}}\n", fmt::join(trim, ", "));
  text += "    signals:\n";
  const GuessedColumn& input = recording.input_column();
  text += input_text(draft, recording, input);
  std::vector<std::string> unused = guess.unused;
  for (const GuessedColumn& c : guess.columns) {
    if (&c == &input || c.kind == Kind::supply) continue;
    if (c.idle && !c.contradicts) {
      text += reasons_text(c, 6) +
              fmt::format("      # {}: {}\n", name_of(draft, c.kind), column_map(c, c.unit));
      continue;
    }
    if (!c.idle && !draft.is_measured(c)) {
      unused.push_back(c.column);
      continue;
    }
    GuessedColumn written = c;
    const bool rounded_away = c.kind == Kind::position && draft.is_rounded_away(c, guess);
    if (rounded_away)
      written.reasons.push_back(
          fmt::format("compared only: its resolution of {:.3g} {} is not noise, and the velocity "
                      "carries the same information",
                      resolution_of(c.values), unit_on(draft.vocabulary(), "m")));
    text += reasons_text(written, 6);
    text += fmt::format(
        "      {}: {}\n", name_of(draft, c.kind),
        rounded_away || c.idle ? column_map(c, c.unit, {"fit", "false"}) : column_map(c, c.unit));
  }
  text += channels_text(draft, guess.channels, unused);
  if (!unused.empty()) text += comment(fmt::format("Not used: {}", fmt::join(unused, ", ")), 4);
  return text;
}

std::string fit_text(const JobDraft& draft) {
  // A mass that a force drives is an open integral: free running it drifts away from the
  // recording whatever the fit.
  const RecordingGuess& first = draft.recordings.front().guess;
  const GuessedColumn *position = first.find(Kind::position),
                      *velocity = first.find(Kind::velocity);
  const bool is_open = draft.is_direct() && draft.recordings.front().input->key !=
                                                std::string_view("position_reference");
  if (!draft.is_direct() && capabilities(draft.structure).has_backlash)
    return "fit:\n" +
           comment(
               "The ringing of the gear and the limits of the drive make wrong minima and narrow "
               "valleys: of several starts the best counts.",
               2) +
           "  starts: 8\n  max_iterations: 150\n";
  if (draft.recordings.front().input->kind == Kind::position)
    return "fit:\n  max_iterations: 150   # what a sampled controller rounds makes the valley "
           "rough\n";
  if (!is_open || position == nullptr) return {};
  const std::vector<double> none;
  const SuggestedGain gain = suggested_observer_gain(
      first.time.values, position->values, velocity && !velocity->idle ? velocity->values : none,
      draft.recordings.front().input_column().values, draft.look ? draft.look->mass.value : 0.0);
  const std::string why =
      gain.is_of_noise
          ? "At a gain below this one the noise of the input would add up in the simulation"
          : "At this gain, an unmodelled hundredth of the acceleration would show as ten times the "
            "noise";
  return "fit:\n" +
         comment("The position is an open-loop integral of the " + draft.say("force") +
                     ": a free-running simulation drifts away however good the fit. An observer "
                     "therefore makes the simulation track the recording, and the fit minimises "
                     "the prediction error. " +
                     why +
                     "; a higher gain hides more. What is missing bends the estimates, by more at "
                     "one gain than at another: if half the gain changes them by more than their "
                     "standard errors, those are too small.",
                 2) +
         fmt::format("  observer: {{fixed: {} 1/s}}\n", round_to_digits(gain.rate, 2));
}

std::string job_text(const JobDraft& draft) {
  std::string text = fmt::format(
      "# Written by axisfit {} --init. It can be run as it is:\n#\n#   fit-params {} --check    "
      "what the recordings show, before the fit\n#   fit-params {}\n#\n# Values marked GUESSED "
      "do not follow from the recordings: check them first. All\n# keys: "
      "docs/job-file.md.\naxis: {}\nrecordings:\n",
      version(), kJobName, kJobName,
      scalar(draft.axis_text.empty() ? draft.relative(draft.request.axis) : kAxisName));
  for (std::size_t i = 0; i < draft.recordings.size(); ++i)
    text += recording_text(draft, draft.recordings[i],
                           draft.recordings.size() > 1 && i + 1 == draft.recordings.size());
  text += fmt::format(
      "free:   # initial values are those of the axis file{}\n",
      draft.starter && draft.starter->gain_guessed ? "; bounds leave room for any K_f" : "");
  for (const DraftParameter& c : draft.parameters) {
    if (c.reason_not_free.empty())
      text += fmt::format("  {}: {}\n", c.name, c.entry);
    else
      text += comment(fmt::format("{}: {}   not free: {}", c.name, c.entry, c.reason_not_free), 2);
  }
  return text + fit_text(draft);
}

}  // namespace

Files job_files(const JobDraft& draft) {
  Files files;
  if (!draft.axis_text.empty()) files.emplace_back(kAxisName, modeline("axis") + draft.axis_text);
  files.emplace_back(kJobName, modeline("job") + job_text(draft));
  return files;
}

}  // namespace axisfit
