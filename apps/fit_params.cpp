// fit-params JOB.yaml: fits the model of an axis to recordings of it.

#include <fmt/format.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "apps/command_line.h"
#include "apps/progress.h"
#include "apps/result_files.h"
#include "apps/run_options.h"
#include "base/terminal.h"
#include "base/text_table.h"
#include "fit/design/run_time_estimate.h"
#include "fit/run.h"
#include "init/machine_choice.h"
#include "init/starter_axis.h"
#include "io/config/axis_file.h"
#include "io/config/config.h"
#include "io/config/job_file.h"
#include "io/config/next_job.h"
#include "io/results/output_folder.h"
#include "report/html/report_page.h"
#include "report/result_json.h"
#include "report/text/report_text.h"
#include "report/text/words.h"

namespace {

using namespace axisfit;

enum ExitCode {  // besides kBadInput
  kUsable = 0,
  kNoUsableFit = 3,
  kTimeLimitReached = 124,  // as that of timeout(1)
  kInterrupted = 130,
};

// The first signal ends the work, a second one the program.
StopFlag stop_flag = false;
StopFlag time_limit_reached = false;  // that was the time limit
static_assert(StopFlag::is_always_lock_free);

void stop_on_signals() {
  struct sigaction action = {};
  action.sa_handler = [](int signal) {
    if (stop_flag.exchange(true)) end_by_signal(signal);
  };
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction inherited = {};
    sigaction(signal, nullptr, &inherited);
    // Who starts a run in the background of a script, or by nohup, does not want it to be stopped.
    if (inherited.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

void stop_after(double seconds) {
  struct sigaction action = {};
  action.sa_handler = [](int) { time_limit_reached = !stop_flag.exchange(true); };
  action.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &action, nullptr);
  const double complete = std::floor(seconds);
  const itimerval once{{0, 0},
                       {static_cast<time_t>(complete),
                        static_cast<suseconds_t>(std::ceil(999'999.0 * (seconds - complete)))}};
  setitimer(ITIMER_REAL, &once, nullptr);
}

int exit_code_of_stop() { return time_limit_reached ? kTimeLimitReached : kInterrupted; }

struct Arguments {
  std::string command;             // as one would type it
  std::vector<std::string> files;  // the job, or the recordings to make one for
  std::string data;
  std::string output;
  std::string from;
  std::string axis, machine;
  std::optional<double> gain;        ///< N/V
  std::vector<std::string> answers;  ///< what columns are
  std::vector<std::string> others;   ///< axis files to compare with
  std::string motion;                ///< motion file to predict; "-": none
  std::vector<std::string> tolerances;
  bool init = false;
  bool check = false;
  RunOptions options;
  std::optional<double> time_limit;  ///< s
  bool resume = false;
  bool json = false;
  bool quiet = false;
  bool no_colour = false;
  std::optional<int> threads, starts;
  std::optional<std::uint64_t> seed;
};

constexpr const char* kShortHelp = R"(Usage: fit-params [OPTIONS] JOB.yaml

Examples:
  fit-params --init step.csv levels.csv    create a job from recordings
  fit-params job.yaml --check              see what the recordings tell
  fit-params job.yaml --output results     fit

All options: fit-params --help
)";

constexpr const char* kExamples = R"(Examples:
  fit-params --init step.csv levels.csv
  fit-params configs/jobs/paper.yaml
  fit-params configs/jobs/close-loop.yaml --close-loop
  fit-params configs/jobs/paper.yaml --check
  fit-params configs/jobs/paper.yaml --profile=V_L,k_g
  fit-params configs/jobs/paper.yaml --suggest-experiment --output results
  fit-params configs/jobs/paper.yaml --output results --starts 20 --seed 7
  fit-params configs/jobs/emps.yaml --data ~/Downloads/EMPS
  fit-params job.yaml --starts 1000 --time-limit 60 --output results
  fit-params job.yaml --json | jq '.parameters[] | {name, value}'

Exit codes: 0 explained or usable, 2 bad input, 3 model wrong, nothing
determined or not converged, 124 stopped by the time limit, 130 by Ctrl-C.)";

/// Begins at the values of another axis, as far as it has them, instead of the job's initial ones.
void start_from(const std::string& axis_file, Job& job) {
  Diagnostics diagnostics;
  auto rig = read_axis_file(axis_file, diagnostics);
  diagnostics.throw_if_any();
  // Without them the values of all others would be wrong.
  const EffectSet extra = rig->model.structure.effects & ~job.model.structure.effects;
  for (std::size_t effect = 0; effect < extra.size(); ++effect)
    if (extra[effect])
      throw std::runtime_error(fmt::format(
          "--from {}: this axis has the effect {}, which the job has not: run the next-job.yaml "
          "beside it, or name the effect in the job",
          axis_file, words_on(vocabulary_of(rig->model.structure), kEffectTable[effect].name)));
  const std::vector<double*> values = members(rig->model);
  for (FreeParameter& p : job.free)
    if (!p.recording && is_used(quantity_list()[p.quantity], rig->model.structure))
      p.initial = std::clamp(*values[p.quantity], p.lower, p.upper);
}

/// Prints the text that `report` makes, which is told whether it may have colours.
template <class Report>
void print_report(const Arguments& arguments, Report&& report) {
  const bool colour = !arguments.no_colour && takes_colour(STDOUT_FILENO);
  const TextWidth narrow(text_width(STDOUT_FILENO));
  const std::string text = report(colour);
  print(colour ? with_bold_headings(text) : text);
}

/// What the recordings show and can tell, before the fit.
int check(const Arguments& arguments, const Job& job, std::optional<ProgressLine>& line) {
  line->update({"checking what the recordings determine"});
  const Forecast found = forecast(job, draw_start(job, 0));
  const RunTimeEstimate run_time = estimate_run_time(job);
  const std::vector<RecordingCheck> recordings = check_recordings(job);
  line.reset();
  if (arguments.json)
    print(check_json(job, recordings, found, run_time).dump(2) + "\n");
  else if (!arguments.quiet)
    print_report(arguments, [&](bool colour) {
      return recordings_text(job, recordings) + "\n" + forecast_text(job, found, colour) + "\n" +
             run_time_text(job, run_time);
    });
  return kUsable;
}

/// Which axes were tried for recordings, and how they did.
std::string tried_text(const MachineChoice& choice) {
  if (choice.tried.size() < 2) return {};
  std::vector<std::vector<std::string>> rows{{"  axis", "free", "error / noise", ""}};
  for (const TriedAxis& tried : choice.tried)
    rows.push_back({tried.name == "mass" ? "  one mass" : "  " + tried.name,
                    std::to_string(tried.parameters),
                    tried.error ? fmt::format("{:.3g}", *tried.error) : "no fit",
                    &tried == &choice.tried.front() ? "chosen" : ""});
  using enum Alignment;
  return fmt::format("Axes tried, with the error of {}\n{}",
                     choice.is_validated ? "the recording that was not fitted" : "what was fitted",
                     format_table(rows, {left, right, right, left}));
}

/// A job file for recordings, and an axis file where none is given.
int init(const Arguments& arguments, std::optional<ProgressLine>& line) {
  namespace fs = std::filesystem;
  const fs::path folder = arguments.output.empty() ? "." : arguments.output;
  std::vector<ColumnAnswer> answers;
  for (const std::string& text : arguments.answers) answers.push_back(read_answer(text));
  const bool is_machine = !arguments.machine.empty();
  MachineChoice choice;
  if (is_machine || !arguments.axis.empty() || arguments.gain)
    choice.job = initial_job(arguments.files, is_machine ? arguments.machine : arguments.axis,
                             folder.string(), arguments.gain, answers, is_machine);
  else
    choice =
        choose_machine(arguments.files, folder.string(), answers,
                       {.progress = [&](const Progress& progress) { line->update(progress); }});
  const InitialJob& created = choice.job;
  const auto path = [&](const std::string& name) {
    return (folder / name).lexically_normal().string();
  };
  line.reset();
  for (const auto& [name, contents] : created.files)
    if (fs::exists(path(name)))
      throw std::runtime_error(
          fmt::format("{} already exists and would be overwritten: move it, or choose another "
                      "folder with --output",
                      path(name)));
  fs::create_directories(folder);
  for (const auto& [name, contents] : created.files) write_file(path(name), contents);
  if (arguments.quiet) return kUsable;
  std::string text;
  for (const auto& [name, contents] : created.files) text += fmt::format("Wrote {}\n", path(name));
  text += tried_text(choice);
  if (!created.guesses.empty()) text += "Guessed, please check\n";
  for (const std::string& guess : created.guesses) text += paragraph(guess, 2);
  const std::string job = path(created.files.back().first);
  print_error(text + fmt::format("Next: fit-params {} --check\n      fit-params {}\n", job, job));
  return kUsable;
}

/// As a shell reads it.
std::string quoted(const std::string& path) {
  if (!path.empty() && path.find_first_of(" \t\n'\"\\$&;|<>()*?[]{}`!#~") == std::string::npos)
    return path;
  std::string text = path;
  for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 4)
    text.replace(at, 1, "'\\''");
  return "'" + text + "'";
}

/// The command line, as one would type it.
std::string command_line_of(int argc, char** argv) {
  std::string line = "fit-params";
  for (int i = 1; i < argc; ++i) line += " " + quoted(argv[i]);
  return line;
}

/// How to go on after Ctrl-C or the time limit.
std::string how_to_continue(const Arguments& arguments) {
  if (arguments.output.empty())
    return "\n" + paragraph(
                      "Nothing was saved. With --output FOLDER, results are saved even when a run "
                      "is stopped, and --resume continues it.");
  return fmt::format("\nTo continue:\n  {}{}\n", arguments.command,
                     arguments.resume ? "" : " --resume");
}

void begin_line(const Arguments& arguments, std::optional<ProgressLine>& line) {
  line.emplace(!arguments.quiet && is_terminal(STDERR_FILENO));
}

/// The folder of the results, with the journal of the run in it.
std::unique_ptr<OutputFolder> open_folder(const Arguments& arguments,
                                          std::vector<std::string> inputs,
                                          std::optional<ProgressLine>& line) {
  if (arguments.output.empty()) return nullptr;
  if (!arguments.from.empty()) inputs.push_back(arguments.from);
  auto folder = std::make_unique<OutputFolder>(arguments.output, result_names(), inputs);
  JournalFile& journal = folder->journal();
  const std::string found = fmt::format("{} solved least-squares problem{}", journal.recovered(),
                                        journal.recovered() == 1 ? "" : "s");
  std::string note;
  if (arguments.resume) {
    journal.resume();
    note = journal.recovered() > 0
               ? fmt::format("Resuming the run in {}: {}.", arguments.output, found)
               : fmt::format("No unfinished run in {}: starting from the beginning.",
                             arguments.output);
  } else if (journal.recovered() > 0) {
    note = fmt::format(
        "{} has {} from an unfinished run. This run starts from the beginning; to resume the "
        "unfinished one, stop this run and add --resume.",
        arguments.output, found);
  }
  if (!arguments.quiet && !note.empty()) {
    line.reset();
    print_error(paragraph(note));
    begin_line(arguments, line);
  }
  return folder;
}

/// Whether a folder holds the whole result of a usable fit.
bool holds_complete_result(const std::string& folder) {
  const std::filesystem::path path = std::filesystem::path(folder) / kResultFile;
  if (!std::filesystem::is_regular_file(path)) return false;
  std::ifstream file(path);
  const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
  const auto is = [&](const char* key, bool value) {
    return json.is_object() && json.contains(key) && json[key] == value;
  };
  return is("usable", true) && is("interrupted", false);
}

/// Writes the result, unless that would replace a better one.
void write(const Arguments& arguments, const JobFile& file, const RunResult& run_result,
           const std::string& json, OutputFolder& folder) {
  const bool complete = !run_result.interrupted;
  if ((!complete || !run_result.grade.is_usable()) && holds_complete_result(arguments.output)) {
    print_error(paragraph(
        fmt::format("{} already holds a usable result, which was kept. To save this one, choose "
                    "another folder with --output.",
                    arguments.output)));
    if (complete) folder.discard_journal();
    return;
  }
  folder.write(
      result_files(file, run_result, json,
                   {arguments.command, arguments.files.front(), arguments.data, arguments.output}),
      complete);
}

/// What a finished run is shown by, before it is written.
using Show = std::function<void(const RunResult&, const std::string& json)>;

/// Reads a job, runs it, shows and writes what it found. The exit code; of a check no result.
int run_job(const Arguments& arguments, std::optional<ProgressLine>& line, const Show& show,
            std::optional<RunResult>& result) {
  JobFile file = read_job_file(arguments.files.front(), arguments.data);
  if (!arguments.from.empty()) start_from(arguments.from, file.job);
  FitOptions& options = file.job.options;
  if (arguments.threads) options.threads = *arguments.threads;
  if (arguments.starts) options.starts = *arguments.starts;
  if (arguments.seed) options.seed = *arguments.seed;
  if (arguments.check) return check(arguments, file.job, line);
  const std::unique_ptr<OutputFolder> folder = open_folder(arguments, file.files, line);

  const RunContext context{&stop_flag, folder ? &folder->journal() : nullptr,
                           [&](const Progress& progress) { line->update(progress); }};
  RunOptions options_of_run = arguments.options;
  options_of_run.others = models_of(arguments.others, file.job);
  for (const std::string& text : arguments.tolerances)
    options_of_run.tolerances.push_back(tolerance_of(text, file.job));
  if (options_of_run.predict && arguments.motion != "-")
    options_of_run.motion = motion_of(arguments.motion, file.rig);
  RunResult& found = result.emplace(run(file.job, options_of_run, context));
  if (found.interrupted && time_limit_reached) found.time_limit = arguments.time_limit;
  const std::string json = result_json(found).dump(2) + "\n";
  line.reset();

  // What was found is shown before anything can go wrong with writing it, and written even if
  // nobody can be shown it.
  std::exception_ptr unseen;
  try {
    show(found, json);
  } catch (const OutputError&) {
    unseen = std::current_exception();
  }
  if (folder) write(arguments, file, found, json, *folder);
  if (unseen) std::rethrow_exception(unseen);
  if (found.interrupted) {
    if (!arguments.quiet) print_error(how_to_continue(arguments));
    return exit_code_of_stop();
  }
  return found.grade.is_usable() ? kUsable : kNoUsableFit;
}

/// One job after the other, each with a folder of its own below that of the results. The exit code
/// is the first that is not kUsable.
int run_axes(const Arguments& arguments, const AxesJob& axes, std::optional<ProgressLine>& line) {
  if (!arguments.from.empty())
    throw std::runtime_error(
        "--from has the values of one axis: leave it out, or run the axes' "
        "jobs one by one");
  if (arguments.check && arguments.json)
    throw std::runtime_error("--check --json is for one axis: run the axes' jobs one by one");
  std::vector<AxisRun> runs;
  int code = kUsable;
  for (const auto& axis : axes.jobs) {
    const std::string& name = axis.first;
    Arguments of_axis = arguments;
    of_axis.files = {axis.second};
    if (!arguments.output.empty())
      of_axis.output = (std::filesystem::path(arguments.output) / name).string();
    if (!line) begin_line(arguments, line);
    const auto heading = [&] {
      print(fmt::format("{}Axis {}\n\n", runs.empty() ? "" : "\n", name));
    };
    if (arguments.check && !arguments.json && !arguments.quiet) {
      line.reset();
      heading();
      begin_line(arguments, line);
    }
    std::optional<RunResult> result;
    const int of_job = run_job(
        of_axis, line,
        [&](const RunResult& found, const std::string&) {
          if (arguments.json || arguments.quiet) return;
          heading();
          print_report(arguments, [&](bool colour) { return report_text(found, colour); });
        },
        result);
    if (code == kUsable) code = of_job;
    if (result) runs.push_back({name, *std::move(result)});
    if (is_set(&stop_flag)) break;
  }
  if (arguments.check) return code;
  if (arguments.json)
    print(axes_json(runs).dump(2) + "\n");
  else if (const std::string text = couplings_text(shared_inertias(runs));
           !text.empty() && !arguments.quiet)
    print_report(arguments, [&](bool) { return "\n" + text; });
  return code;
}

int run_command(const Arguments& arguments) {
  std::optional<ProgressLine> line;
  begin_line(arguments, line);
  line->update({"reading the recordings"});
  if (arguments.init) return init(arguments, line);
  if (arguments.files.size() > 1)
    throw std::runtime_error(
        fmt::format("only one job file can be given; unexpected: {} (to create a job from "
                    "recordings, use --init)",
                    arguments.files[1]));
  const std::string& job = arguments.files.front();
  for (const char* ending : {".csv", ".txt", ".gz", ".mat", ".mcap", ".xlsx"})
    if (job.ends_with(ending))
      throw std::runtime_error(fmt::format(
          "{} is a recording; to create a job for it: fit-params --init {}", job, quoted(job)));
  if (const auto axes = read_axes_job(job)) return run_axes(arguments, *axes, line);
  std::optional<RunResult> result;
  return run_job(
      arguments, line,
      [&](const RunResult& found, const std::string& json) {
        if (arguments.json)
          print(json);
        else if (!arguments.quiet)
          print_report(arguments, [&](bool colour) { return report_text(found, colour); });
      },
      result);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app{"Fits the model of a robot axis to recordings, as described by a job file.",
               "fit-params"};
  app.footer(kExamples);
  app.add_option("JOB.yaml", arguments.files,
                 "job file (docs/job-file.md); with --init, recordings (CSV or MATLAB)")
      ->required();
  app.option_defaults()->group("Fit");
  auto* check = app.add_flag("--check", arguments.check,
                             "do not fit; report what the recordings contain, which free "
                             "parameters they determine, and how long the fit will take");
  auto* data = app.add_option("--data", arguments.data,
                              "folder of the recordings, if not that of the job file")
                   ->check(kNotEmpty)
                   ->type_name("FOLDER");
  auto* from = app.add_option("--from", arguments.from,
                              "start from the values of this axis file, such as fitted.yaml")
                   ->check(kNotEmpty)
                   ->type_name("AXIS.yaml");
  app.add_option("--starts", arguments.starts,
                 "number of starts, the first from the initial values; default: as in the job")
      ->transform(whole_number(1, 1'000'000));
  app.add_option("--seed", arguments.seed, "seed of the random starts; default: as in the job")
      ->transform(whole_number<std::uint64_t>(0));
  std::string profiles;
  auto* profile =
      app.add_flag("--profile{all}", profiles,
                   "likelihood profiles of all parameters, or of some: --profile=NAME,NAME")
          ->excludes(check);
  app.add_option("--threads", arguments.threads, "number of threads; default: all cores")
      ->transform(whole_number(1, 1024));
  auto* time_limit =
      app.add_option("--time-limit", arguments.time_limit,
                     "stop after this many seconds and keep what is finished, as Ctrl-C does")
          ->check(number(0.001, 1e8))
          ->excludes(check)
          ->type_name("SECONDS");

  auto* predict =
      app.add_flag("--predict{-}", arguments.motion,
                   "predict the recordings to validate, with 95 % bands, and a motion that nobody "
                   "recorded: --predict=MOTION.yaml; written to prediction.csv and "
                   "predicted-motion.csv in --output")
          ->excludes(check);
  app.add_option("--within", arguments.tolerances,
                 "with --predict: say until when the bands are within this error, such as 1mm; may "
                 "be given for several units")
      ->needs(predict)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->type_name("AMOUNT");

  std::string others;
  auto* compare =
      app.add_flag("--compare{-}", others,
                   "compare the models of --close-loop on the recordings to validate, and those of "
                   "axis files: --compare=FITTED.yaml,FITTED.yaml")
          ->excludes(check);

  app.option_defaults()->group("Effect selection");
  auto* close = app.add_flag("--close-loop", arguments.options.select_effects,
                             "after the fit, add effects that the model lacks, each validated on "
                             "data that were not fitted")
                    ->excludes(check);
  auto* experiment =
      app.add_flag("--suggest-experiment", arguments.options.suggest_experiment,
                   "suggest the motion to record next; written to next-motion.yaml in --output")
          ->excludes(check);

  app.option_defaults()->group("First job");
  auto* init = app.add_flag("--init", arguments.init,
                            "create job.yaml and axis.yaml from recordings; columns, units and "
                            "signals are inferred from names and values")
                   ->excludes(check)
                   ->excludes(data)
                   ->excludes(from)
                   ->excludes(profile)
                   ->excludes(time_limit)
                   ->excludes(close)
                   ->excludes(experiment)
                   ->excludes(predict)
                   ->excludes(compare);
  auto* axis = app.add_option("--axis", arguments.axis, "with --init: use this axis file")
                   ->needs(init)
                   ->check(kNotEmpty)
                   ->type_name("AXIS.yaml");
  auto* machine = app.add_option("--machine", arguments.machine,
                                 "with --init: begin with the axis file of such a machine")
                      ->needs(init)
                      ->excludes(axis)
                      ->check(CLI::IsMember(machine_names()))
                      ->type_name("NAME");
  const Quantity& gain = find_quantity("K_f", Joint::revolute)->quantity;
  app.add_option("--gain", arguments.gain,
                 "with --init: force in N, or torque in N m, per unit of the recorded current or "
                 "command, or at 100 % of the rating")
      ->needs(init)
      ->excludes(axis)
      ->excludes(machine)
      ->check(number(gain.lower, gain.upper))
      ->type_name("K_f");
  app.add_option("--column", arguments.answers,
                 "with --init: what a column is, such as position=\"Geber [Ink]:um/8\"; may be "
                 "given several times")
      ->needs(init)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->type_name("SIGNAL=COLUMN:UNIT");

  app.option_defaults()->group("Results");
  auto* output = app.add_option("-o,--output", arguments.output,
                                "folder for report.html, result.json, fitted.yaml and "
                                "residuals.csv; with --init, for the job")
                     ->check(kNotEmpty)
                     ->type_name("FOLDER");
  app.add_flag("--resume", arguments.resume,
               "resume a run that was stopped or killed, from its journal in --output")
      ->needs(output)
      ->excludes(init)
      ->excludes(check);
  auto* json = app.add_flag("--json", arguments.json, "print result.json instead of the tables")
                   ->excludes(init);
  app.add_flag("-q,--quiet", arguments.quiet, "print errors only")->excludes(json);
  app.add_flag("--no-color", arguments.no_colour, "print without colours and bold headings");

  return run_program(app, kShortHelp, argc, argv, [&] {
    arguments.command = command_line_of(argc, argv);
    for (std::istringstream names(profiles); std::getline(names, profiles, ',');)
      arguments.options.profiles.push_back(profiles);
    arguments.options.predict = predict->count() > 0;
    arguments.options.compare = compare->count() > 0;
    if (others != "-")
      for (std::istringstream names(others); std::getline(names, others, ',');)
        arguments.others.push_back(others);
    stop_flag = arguments.init || arguments.check;  // there is nothing to keep
    stop_on_signals();
    if (arguments.time_limit) stop_after(*arguments.time_limit);
    try {
      return run_command(arguments);
    } catch (const Interrupted&) {
      if (!arguments.quiet)
        print_error(fmt::format("Stopped{} before any fit finished: there is no result.\n{}",
                                time_limit_reached ? " by the time limit" : "",
                                how_to_continue(arguments)));
      return exit_code_of_stop();
    }
  });
}
