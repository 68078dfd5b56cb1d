// fit-params JOB.yaml: fits the model of an axis to recordings of it.

#include <fmt/format.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "apps/command_line.h"
#include "apps/progress.h"
#include "base/terminal.h"
#include "base/text_table.h"
#include "fit/design/run_time_estimate.h"
#include "fit/run.h"
#include "init/init_job.h"
#include "io/config/axis_file.h"
#include "io/config/config.h"
#include "io/config/job_file.h"
#include "io/config/motion_file.h"
#include "io/results/output_folder.h"
#include "report/html/report_page.h"
#include "report/result_json.h"
#include "report/text/report_text.h"

namespace {

using namespace axisfit;

constexpr const char* kResultFile = "result.json";
constexpr const char* kAxisFile = "fitted.yaml";
constexpr const char* kResidualsFile = "residuals.csv";
constexpr const char* kReportFile = "report.html";
constexpr const char* kMotionFile = "next-motion.yaml";

enum ExitCode {  // besides kBadInput
  kUsable = 0,
  kNoUsableFit = 3,
  kOutOfTime = 124,  // as that of timeout(1)
  kInterrupted = 130,
};

// The first signal ends the work, a second one the program.
StopFlag stop_flag = false;
StopFlag out_of_time = false;  // that was the time limit
static_assert(StopFlag::is_always_lock_free);

void stop_on_signals() {
  struct sigaction action = {};
  action.sa_handler = [](int signal) {
    if (stop_flag.exchange(true)) end_by_signal(signal);
  };
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

void stop_after(double seconds) {
  struct sigaction action = {};
  action.sa_handler = [](int) { out_of_time = !stop_flag.exchange(true); };
  action.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &action, nullptr);
  const double whole = std::floor(seconds);
  const itimerval once{{0, 0},
                       {static_cast<time_t>(whole),
                        static_cast<suseconds_t>(std::ceil(999'999.0 * (seconds - whole)))}};
  setitimer(ITIMER_REAL, &once, nullptr);
}

int exit_code_of_stop() { return out_of_time ? kOutOfTime : kInterrupted; }

struct Arguments {
  std::string command;             // as one would type it
  std::vector<std::string> files;  // the job, or the recordings to make one for
  std::string data;
  std::string output;
  std::string from;
  std::string axis;
  bool init = false;
  bool check = false;
  Wishes wishes;
  bool resume = false;
  bool json = false;
  bool quiet = false;
  std::optional<int> threads, starts;
  std::optional<std::uint64_t> seed;
};

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

Exit codes: 0 usable fit, 2 bad input, 3 no usable fit, 124 stopped by the time
limit, 130 by Ctrl-C.)";

/// Begins at the values of another axis, as far as it has them, instead of the job's initial ones.
void begin_at(const std::string& axis_file, Job& job) {
  Diagnostics diagnostics;
  auto rig = read_axis_file(axis_file, diagnostics);
  diagnostics.throw_if_any();
  const std::vector<double*> values = members(rig->model);
  for (FreeParameter& p : job.free)
    if (!p.recording && is_used(quantity_list()[p.quantity], rig->model.structure))
      p.initial = std::clamp(*values[p.quantity], p.lower, p.upper);
}

/// A text for standard output.
void print(const std::string& text) {
  if (!(std::cout << text).flush()) throw std::runtime_error("cannot write to standard output");
}

std::string for_stdout(const std::string& report) {
  return takes_colour(STDOUT_FILENO) ? coloured(report) : report;
}

/// What the recordings show and can tell, before the fit.
int check(const Arguments& arguments, const Job& job, std::optional<ProgressLine>& line) {
  line->tell({"looking at what the recordings can tell"});
  const Forecast found = forecast(job, draw_start(job, 0));
  const Effort effort = expected_effort(job);
  const std::vector<RecordingCheck> recordings = check_recordings(job);
  line.reset();
  if (arguments.json)
    print(check_json(job, recordings, found, effort).dump(2) + "\n");
  else if (!arguments.quiet)
    print(for_stdout(recordings_text(job, recordings) + "\n" + forecast_text(job, found) + "\n" +
                     effort_text(job, effort)));
  return kUsable;
}

/// A job file for recordings, and an axis file where none is given.
int init(const Arguments& arguments, std::optional<ProgressLine>& line) {
  namespace fs = std::filesystem;
  const fs::path folder = arguments.output.empty() ? "." : arguments.output;
  const InitialJob made = initial_job(arguments.files, arguments.axis, folder.string());
  const auto path = [&](const std::string& name) {
    return (folder / name).lexically_normal().string();
  };
  line.reset();
  for (const auto& [name, contents] : made.files)
    if (fs::exists(path(name)))
      throw std::runtime_error(
          fmt::format("{} is there already and would be overwritten: move it away, or name another "
                      "folder with --output",
                      path(name)));
  fs::create_directories(folder);
  for (const auto& [name, contents] : made.files) write_file(path(name), contents);
  if (arguments.quiet) return kUsable;
  std::string text;
  for (const auto& [name, contents] : made.files) text += fmt::format("Written: {}\n", path(name));
  if (!made.guesses.empty()) text += "To look at, for nothing in the recordings says it\n";
  for (const std::string& guess : made.guesses) text += paragraph(guess, 2);
  const std::string job = path(made.files.back().first);
  std::cerr << text << fmt::format("Next: fit-params {} --check\n      fit-params {}\n", job, job);
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
std::string typed(int argc, char** argv) {
  std::string line = "fit-params";
  for (int i = 1; i < argc; ++i) line += " " + quoted(argv[i]);
  return line;
}

Files files_of(const Arguments& arguments, const JobFile& file, const Outcome& outcome,
               const std::string& json) {
  Rig fitted = file.rig;
  fitted.model = fitted_model(outcome.job(), outcome.fit());
  const std::string origin = fmt::format("axisfit {} from {}, starting from {}", version(),
                                         arguments.files.front(), file.axis_file);
  Files files{{kResultFile, json},
              {kAxisFile, format_axis_file(fitted, fmt::format("Fitted by {}.\n{}", origin,
                                                               verdict_of(outcome)))},
              {kResidualsFile, residuals_csv(outcome.job(), outcome.fit(), outcome.diagnosis)},
              {kReportFile, report_page(outcome, {arguments.command, arguments.files.front(),
                                                  file.text, file.axis_file, file.axis_text})}};
  if (const Experiment* next = next_experiment(outcome)) {
    files.emplace_back(
        kMotionFile, format_motion_file({next->motion, next->duration},
                                        fmt::format("Suggested by {}:\n{}.", origin, next->words)));
  }
  return files;
}

/// How to go on after Ctrl-C or the time limit.
std::string advice(const Arguments& arguments) {
  if (arguments.output.empty())
    return "\n" + paragraph(
                      "Nothing is written: with --output FOLDER the result is kept, also when "
                      "stopped, and --resume goes on from there.");
  return fmt::format("\nTo go on from here:\n  {}{}\n", arguments.command,
                     arguments.resume ? "" : " --resume");
}

void begin_line(const Arguments& arguments, std::optional<ProgressLine>& line) {
  line.emplace(!arguments.quiet && is_terminal(STDERR_FILENO));
}

/// The folder of the results with the journal of the run in it, which becomes the job's.
std::unique_ptr<OutputFolder> open_folder(const Arguments& arguments, Job& job,
                                          std::optional<ProgressLine>& line) {
  if (arguments.output.empty()) return nullptr;
  auto folder = std::make_unique<OutputFolder>(
      arguments.output,
      std::vector<std::string>{kResultFile, kAxisFile, kResidualsFile, kReportFile, kMotionFile});
  JournalFile& journal = folder->journal();
  job.options.journal = &journal;
  const std::string found =
      fmt::format("{} solved problem{}", journal.earlier(), journal.earlier() == 1 ? "" : "s");
  std::string note;
  if (arguments.resume) {
    journal.go_on();
    note = journal.earlier() > 0
               ? fmt::format("Going on with the run that ended in {}: {}.", arguments.output, found)
               : fmt::format("No unfinished run in {}: beginning anew.", arguments.output);
  } else if (journal.earlier() > 0) {
    note = fmt::format(
        "{} has {} of a run that did not end. This one begins anew; to go on with that one, stop "
        "this and add --resume.",
        arguments.output, found);
  }
  if (!arguments.quiet && !note.empty()) {
    line.reset();
    std::cerr << paragraph(note);
    begin_line(arguments, line);
  }
  return folder;
}

/// Whether a folder holds the whole result of a usable fit.
bool holds_whole_result(const std::string& folder) {
  std::ifstream file(std::filesystem::path(folder) / kResultFile);
  const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
  const auto is = [&](const char* key, bool value) {
    return json.is_object() && json.contains(key) && json[key] == value;
  };
  return is("usable", true) && is("interrupted", false);
}

/// Writes the result, unless that would replace a better one.
void write(const Arguments& arguments, const JobFile& file, const Outcome& outcome,
           const std::string& json, OutputFolder& folder) {
  const bool whole = !outcome.interrupted;
  if ((!whole || !outcome.fit().usable) && holds_whole_result(arguments.output)) {
    std::cerr << paragraph(fmt::format(
        "{} keeps the usable result that it holds. To write this one, name another folder with "
        "--output.",
        arguments.output));
    if (whole) folder.forget();
    return;
  }
  folder.write(files_of(arguments, file, outcome, json), whole);
}

int run(const Arguments& arguments) {
  std::optional<ProgressLine> line;
  begin_line(arguments, line);
  line->tell({"reading the recordings"});
  if (arguments.init) return init(arguments, line);
  if (arguments.files.size() > 1)
    throw std::runtime_error(fmt::format(
        "one job at a time: {} is one too many (to make a job for recordings, say --init)",
        arguments.files[1]));
  const std::string& job = arguments.files.front();
  for (const char* ending : {".csv", ".mat"})
    if (job.ends_with(ending))
      throw std::runtime_error(fmt::format(
          "{} is a recording; a job for it is made by: fit-params --init {}", job, quoted(job)));
  JobFile file = read_job_file(job, arguments.data);
  if (!arguments.from.empty()) begin_at(arguments.from, file.job);
  FitOptions& options = file.job.options;
  if (arguments.threads) options.threads = *arguments.threads;
  if (arguments.starts) options.starts = *arguments.starts;
  if (arguments.seed) options.seed = *arguments.seed;
  if (arguments.check) return check(arguments, file.job, line);
  const std::unique_ptr<OutputFolder> folder = open_folder(arguments, file.job, line);

  Outcome outcome = find_outcome(file.job, arguments.wishes,
                                 [&](const Progress& progress) { line->tell(progress); });
  outcome.out_of_time = outcome.interrupted && out_of_time;
  const std::string json = result_json(outcome).dump(2) + "\n";
  line.reset();

  // What was found is shown before anything can go wrong with writing it.
  if (arguments.json)
    print(json);
  else if (!arguments.quiet)
    print(for_stdout(report_text(outcome)));
  if (folder) write(arguments, file, outcome, json, *folder);
  if (outcome.interrupted) {
    if (!arguments.quiet) std::cerr << advice(arguments);
    return exit_code_of_stop();
  }
  return outcome.fit().usable ? kUsable : kNoUsableFit;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app{"Fits the model of a robot axis to recordings of it, as a job file describes.",
               "fit-params"};
  app.footer(kExamples);
  app.add_option("JOB.yaml", arguments.files,
                 "the job file (docs/job-file.md); with --init recordings, CSV or MATLAB")
      ->required();
  auto* close =
      app.add_flag("--close-loop", arguments.wishes.close_loop,
                   "then add the effects that the model lacks, each checked by data not fitted");
  std::string profiles;
  auto* profile = app.add_flag("--profile{all}", profiles,
                               "likelihood profiles: of all parameters, or --profile=NAME,NAME");
  auto* experiment = app.add_flag("--suggest-experiment", arguments.wishes.experiment,
                                  "say which motion to record next; next-motion.yaml in --output");
  auto* check = app.add_flag("--check", arguments.check,
                             "do not fit: say what the recordings show, what they can tell of the "
                             "free parameters, and how long the fit will take")
                    ->excludes(close)
                    ->excludes(profile)
                    ->excludes(experiment);
  auto* data =
      app.add_option("--data", arguments.data, "folder of the recordings, if not the job file's")
          ->type_name("FOLDER");
  auto* from = app.add_option("--from", arguments.from,
                              "begin at the values of this axis file, such as a fitted.yaml")
                   ->type_name("AXIS.yaml");
  auto* output =
      app.add_option("--output", arguments.output,
                     "folder for report.html, result.json, fitted.yaml and residuals.csv; with "
                     "--init for the job")
          ->type_name("FOLDER");
  auto* json = app.add_flag("--json", arguments.json, "print result.json instead of the table");
  app.add_flag("--quiet", arguments.quiet, "print nothing but errors")->excludes(json);
  auto* init = app.add_flag("--init", arguments.init,
                            "write job.yaml, and axis.yaml, for recordings: columns, units and "
                            "signals as their names and values tell")
                   ->excludes(close)
                   ->excludes(profile)
                   ->excludes(experiment)
                   ->excludes(check)
                   ->excludes(data)
                   ->excludes(from)
                   ->excludes(json);
  app.add_flag("--resume", arguments.resume,
               "go on with a run that was stopped or killed, from what it left in --output")
      ->needs(output)
      ->excludes(init)
      ->excludes(check);
  app.add_option("--axis", arguments.axis, "with --init: the axis file, if there is one")
      ->needs(init)
      ->type_name("AXIS.yaml");
  app.add_option("--threads", arguments.threads, "number of threads; default: all cores")
      ->check(CLI::Range(1, 1024));
  app.add_option("--seed", arguments.seed, "seed of the random starts; default: the job's")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--starts", arguments.starts,
                 "number of starts, the first from the initial values; default: the job's")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--time-limit", arguments.wishes.time_limit,
                 "stop after so many seconds and keep what is finished, as by Ctrl-C")
      ->check(CLI::Range(0.001, 1e8))
      ->excludes(init)
      ->excludes(check)
      ->type_name("SECONDS");
  return run_program(app, argc, argv, [&] {
    arguments.command = typed(argc, argv);
    for (std::istringstream names(profiles); std::getline(names, profiles, ',');)
      arguments.wishes.profiles.push_back(profiles);
    arguments.wishes.stop = &stop_flag;
    stop_flag = arguments.init || arguments.check;  // there is nothing to keep
    stop_on_signals();
    if (arguments.wishes.time_limit) stop_after(*arguments.wishes.time_limit);
    try {
      return run(arguments);
    } catch (const Interrupted&) {
      if (!arguments.quiet)
        std::cerr << fmt::format("Stopped{} before a fit was finished: there is no result.\n",
                                 out_of_time ? " by the time limit" : "")
                  << advice(arguments);
      return exit_code_of_stop();
    }
  });
}
