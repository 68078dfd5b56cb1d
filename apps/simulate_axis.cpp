// simulate-axis AXIS.yaml MOTION.yaml: a recording as a rig would make it.
// simulate-axis MACHINE.yaml --output FOLDER: one of each axis of a machine.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <sstream>

#include "apps/command_line.h"
#include "apps/progress.h"
#include "base/parallel.h"
#include "base/terminal.h"
#include "io/config/axis_file.h"
#include "io/config/machine_file.h"
#include "io/config/motion_file.h"
#include "io/recording/csv.h"
#include "io/results/output_folder.h"
#include "sim/rig.h"

namespace {

using namespace axisfit;

struct Arguments {
  std::string axis, motion, output;
  std::vector<std::string> changes, signals;
  RecordingOptions recording;
  bool signals_given = false;
  bool exact = false;
  bool band = false;
};

constexpr const char* kShortHelp = R"(Usage: simulate-axis [OPTIONS] AXIS.yaml MOTION.yaml

Examples:
  simulate-axis axis.yaml step.yaml > step.csv
  simulate-axis axis.yaml move.yaml --set "M=161 kg" --output move.csv
  simulate-axis machine.yaml --output recordings

All options: simulate-axis --help
)";

constexpr const char* kExamples = R"(Examples:
  simulate-axis configs/axes/x.yaml configs/motions/step.yaml --output step.csv
  simulate-axis configs/axes/x.yaml configs/motions/move.yaml --seed 7 \
      --set "M=161 kg" --output move.csv
  simulate-axis results/fitted.yaml configs/motions/chirp.yaml \
      --signals velocity motor_current
  simulate-axis configs/machines/robot.yaml --output recordings

Exit codes: 0 recorded, 2 bad input.)";

/// Applies "NAME=VALUE UNIT".
void change(const std::string& text, Model<double>& model) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    throw std::runtime_error(
        fmt::format("--set '{}': write NAME=VALUE, for example --set 'M=161 kg'", text));
  Diagnostics diagnostics;
  std::string value = text.substr(equals + 1);
  for (std::size_t at = 0; (at = value.find('\'', at)) != std::string::npos; at += 2)
    value.insert(at, 1, '\'');  // how YAML writes a quote within quotes
  const std::string yaml = text.substr(0, equals) + ": '" + value + "'";
  if (const auto root = ConfigNode::parse(yaml, "--set", diagnostics)) {
    for (ConfigMap map(*root); const auto& [key, given] : map.entries())
      if (const QuantityEntry* entry = quantity_named(key, model.structure))
        *members(model)[entry->index] =
            read_value(given, entry->quantity).value_or(entry->quantity.lower);
  }
  diagnostics.throw_if_any();
}

/// The signals that were asked for and that the axis has, in this order.
std::vector<Signal> signals_of(const Arguments& arguments, const Structure& structure) {
  std::vector<Signal> signals;
  const Vocabulary vocabulary = vocabulary_of(structure);
  for (const std::string& name : arguments.signals) {
    const auto signal = signal_by_name(name, vocabulary);
    if (!signal)
      throw std::runtime_error(fmt::format("--signals: on a {} joint there is no {}",
                                           joint_name(vocabulary.joint), name));
    if (std::ranges::find(signals, *signal) != signals.end())
      throw std::runtime_error(fmt::format("--signals: {} is named twice", name));
    if (has_signal(*signal, structure))
      signals.push_back(*signal);
    else if (arguments.signals_given)
      throw std::runtime_error(fmt::format("--signals: the drive of this axis has no {}", name));
  }
  return signals;
}

/// The length of so many recordings, which must not be too long.
void set_duration(double duration, double files, const std::string& path,
                  RecordingOptions& options) {
  constexpr double kMaxRows = 2e7;
  if (duration * options.rate * files > kMaxRows)
    throw std::runtime_error(
        fmt::format("{}: {:g} s at {:g} samples per second give more than {:g} rows: choose a "
                    "shorter duration or a lower --rate",
                    path, duration, options.rate, kMaxRows));
  options.duration = duration;
}

std::string csv_of(const std::vector<Column>& columns, bool exact) {
  std::ostringstream text;
  write_csv(text, columns, exact ? 0 : 9);
  return text.str();
}

/// What a machine file leaves no room for.
std::runtime_error no_more_than_a_machine(const std::string& path) {
  return std::runtime_error(
      fmt::format("{} is a machine: it names the motions and effects of its axes itself; leave "
                  "out MOTION.yaml and --set",
                  path));
}

void run_machine(Arguments arguments) {
  if (!arguments.changes.empty()) throw no_more_than_a_machine(arguments.axis);
  if (arguments.band)
    throw std::runtime_error(fmt::format(
        "--band is for the axes of {} one by one: its axes act on each other", arguments.axis));
  if (arguments.output.empty())
    throw std::runtime_error("name a folder for the recordings of the axes: --output FOLDER");
  const MachineFile machine = read_machine_file(arguments.axis);
  RecordingOptions& options = arguments.recording;
  set_duration(machine.duration, static_cast<double>(machine.axes.size()), arguments.axis, options);
  std::vector<ResultName> names;
  std::vector<std::vector<Signal>> signals;
  for (const CoupledAxis& axis : machine.axes) {
    names.push_back({axis.name + ".csv", "time_s,"});
    signals.push_back(signals_of(arguments, axis.rig.model.structure));
  }
  OutputFolder folder(arguments.output, names, machine.files);
  MachineRecording recording;
  {
    ProgressLine line(is_terminal(STDERR_FILENO));
    line.update({"simulating"});
    recording = record_machine(machine.axes, signals, options);
  }
  Files files;
  for (std::size_t a = 0; a < machine.axes.size(); ++a)
    files.emplace_back(names[a].name, csv_of(recording.axes[a], arguments.exact));
  folder.write(files, true);
  print(
      fmt::format("{} axes, each simulated {} times; in the end no motion changed by more than "
                  "{:.1g} of its range.\n",
                  machine.axes.size(), recording.sweeps, recording.change));
}

void run_command(Arguments arguments) {
  arguments.recording.noise = !arguments.exact;
  if (arguments.motion.empty()) {
    if (is_machine_file(arguments.axis)) return run_machine(std::move(arguments));
    throw std::runtime_error(fmt::format(
        "name the motion of {}, too: simulate-axis AXIS.yaml MOTION.yaml", arguments.axis));
  }
  Diagnostics diagnostics;
  auto rig = read_axis_file(arguments.axis, diagnostics);
  if (!rig && is_machine_file(arguments.axis)) throw no_more_than_a_machine(arguments.axis);
  diagnostics.throw_if_any();
  for (const std::string& text : arguments.changes) change(text, rig->model);
  if (const std::string reason = model_error(rig->model); !reason.empty())
    throw std::runtime_error(reason);
  const MotionFile motion = read_motion_file(arguments.motion, *rig);
  if (!arguments.output.empty())
    refuse_to_overwrite(arguments.output, {arguments.axis, arguments.motion, motion.recording});
  RecordingOptions& options = arguments.recording;
  set_duration(motion.duration, 1.0, arguments.motion, options);
  options.signals = signals_of(arguments, rig->model.structure);
  std::vector<Column> columns;
  {
    ProgressLine line(is_terminal(STDERR_FILENO));
    line.update({"simulating"});
    if (arguments.band) {
      const ThreadPool pool(0);
      columns = record_with_bands(*rig, motion.motion, options);
    } else {
      columns = record(*rig, motion.motion, options);
    }
  }
  const std::string text = csv_of(columns, arguments.exact);
  if (arguments.output.empty())
    print(text);
  else
    write_file(arguments.output, text);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  std::vector<std::string> signals;
  for (const Joint joint : kJoints)
    for (const SignalInfo& signal : kSignalTable)
      if (const std::string name(info(signal.signal, joint).name);
          std::ranges::find(signals, name) == signals.end())
        signals.push_back(name);
  arguments.signals = {"position", "velocity", "acceleration", "tachometer", "motor_current"};
  CLI::App app{
      "Simulates a motion of an axis, or of all axes of a machine, and records it as a test rig "
      "would: sampled, with noise, encoder quantisation, and sensor bias and gain.",
      "simulate-axis"};
  app.footer(kExamples);
  app.add_option("AXIS.yaml", arguments.axis,
                 "axis file (docs/axis-file.md), or a machine file (docs/machine-file.md)")
      ->required();
  app.add_option("MOTION.yaml", arguments.motion,
                 "motion file (docs/motion-file.md); none with a machine file");
  app.add_option("-o,--output", arguments.output,
                 "CSV file, standard output by default; of a machine a folder")
      ->check(kNotEmpty)
      ->type_name("FILE");
  app.add_option("--set", arguments.changes, "change a quantity; give the value with its unit")
      ->take_all()
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  const auto* chosen =
      app.add_option("--signals", arguments.signals,
                     fmt::format("signals to record: any of {}", fmt::join(signals, ", ")))
          ->check(CLI::IsMember(signals))
          ->option_text("NAME ...")
          ->default_str(fmt::format("{}", fmt::join(arguments.signals, ", ")));
  app.add_option("--rate", arguments.recording.rate, "samples per second")
      ->check(number(1.0, 1e6))
      ->capture_default_str();
  app.add_option("--seed", arguments.recording.seed, "seed of the noise")
      ->transform(whole_number<std::uint64_t>(0))
      ->capture_default_str();
  app.add_flag("--exact", arguments.exact, "no noise, no encoder quantisation, all digits");
  app.add_flag(
      "--band", arguments.band,
      "the fitted.yaml of fit-params, without noise, and for each signal the half widths of "
      "its 95 % bands: at any one time, and for the whole curve");
  for (const int signal : {SIGINT, SIGTERM})
    if (std::signal(signal, end_by_signal) == SIG_IGN) std::signal(signal, SIG_IGN);
  return run_program(app, kShortHelp, argc, argv, [&] {
    arguments.signals_given = chosen->count() > 0;
    run_command(std::move(arguments));
    return 0;
  });
}
