// fit-params JOB.yaml: fits the model of an axis to recordings of it.

#include <fmt/format.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/command_line.h"
#include "apps/first_job.h"
#include "apps/fit_arguments.h"
#include "apps/progress.h"
#include "apps/result_files.h"
#include "apps/run_options.h"
#include "base/terminal.h"
#include "fit/design/run_time_estimate.h"
#include "fit/first_look/job_look.h"
#include "fit/run.h"
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
StopFlag stop_flag;
StopFlag search_over(&stop_flag);              // there is time left to judge what a search found
std::atomic<bool> time_limit_reached = false;  // that was the time limit
static_assert(StopFlag::is_always_lock_free);

void stop_on_signals() {
  struct sigaction action = {};
  action.sa_handler = [](int signal) {
    if (stop_flag.set()) end_by_signal(signal);
  };
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction inherited = {};
    sigaction(signal, nullptr, &inherited);
    // Who starts a run in the background of a script, or by nohup, does not want it to be stopped.
    if (inherited.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

timeval time_of(double seconds) {
  const double complete = std::floor(seconds);
  return {static_cast<time_t>(complete),
          static_cast<suseconds_t>(std::ceil(999'999.0 * (seconds - complete)))};
}

/// The first alarm ends a search, the second one all.
void stop_after(double seconds) {
  struct sigaction action = {};
  action.sa_handler = [](int) {
    if (search_over.set() && !stop_flag.set()) time_limit_reached = true;
  };
  action.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &action, nullptr);
  const itimerval alarms{time_of((1.0 - kPartOfSearch) * seconds),
                         time_of(kPartOfSearch * seconds)};
  setitimer(ITIMER_REAL, &alarms, nullptr);
}

int exit_code_of_stop() { return time_limit_reached ? kTimeLimitReached : kInterrupted; }

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
void print_report(const FitArguments& arguments, Report&& report) {
  const bool colour = !arguments.no_colour && takes_colour(STDOUT_FILENO);
  const TextWidth narrow(text_width(STDOUT_FILENO));
  const std::string text = report(colour);
  print(colour ? with_bold_headings(text) : text);
}

/// What the recordings show and can tell, before the fit.
int check(const FitArguments& arguments, const Job& job, std::optional<ProgressLine>& line) {
  line->update({"checking what the recordings determine"});
  const Forecast found = forecast(job, draw_start(job, 0));
  const RunTimeEstimate run_time = estimate_run_time(job);
  const std::vector<RecordingCheck> recordings = check_recordings(job);
  const std::optional<FirstLook> look = look_at(job);
  line.reset();
  if (arguments.json)
    print(check_json(job, recordings, look, found, run_time).dump(2) + "\n");
  else if (!arguments.quiet)
    print_report(arguments, [&](bool colour) {
      return recordings_text(job, recordings) + first_look_text(job, look) + "\n" +
             forecast_text(job, found, colour) + "\n" + run_time_text(job, run_time);
    });
  return kUsable;
}

/// How to go on after Ctrl-C or the time limit.
std::string how_to_continue(const FitArguments& arguments) {
  if (arguments.output.empty())
    return "\n" + paragraph(
                      "Nothing was saved. With --output FOLDER, results are saved even when a run "
                      "is stopped, and --resume continues it.");
  return fmt::format("\nTo continue:\n  {}{}\n", arguments.command,
                     arguments.resume ? "" : " --resume");
}

void begin_line(const FitArguments& arguments, std::optional<ProgressLine>& line) {
  line.emplace(!arguments.quiet && is_terminal(STDERR_FILENO));
}

/// The folder of the results, with the journal of the run in it.
std::unique_ptr<OutputFolder> open_folder(const FitArguments& arguments,
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
void write(const FitArguments& arguments, const JobFile& file, const RunResult& run_result,
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
int run_job(const FitArguments& arguments, std::optional<ProgressLine>& line, const Show& show,
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
                           [&](const Progress& progress) { line->update(progress); }, &search_over};
  RunOptions options_of_run = arguments.options;
  options_of_run.others = models_of(arguments.others, file.job);
  for (const std::string& text : arguments.tolerances)
    options_of_run.tolerances.push_back(tolerance_of(text, file.job));
  if (options_of_run.predict && arguments.motion != "-")
    options_of_run.motion = motion_of(arguments.motion, file.rig);
  set_profiles(arguments.profiled, file.job, options_of_run);
  RunResult& found = result.emplace(run(file.job, options_of_run, context));
  if (found.selection && found.selection->cut_short && !is_set(&stop_flag))
    time_limit_reached = true;
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
int run_axes(const FitArguments& arguments, const AxesJob& axes,
             std::optional<ProgressLine>& line) {
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
    FitArguments of_axis = arguments;
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

int run_command(const FitArguments& arguments) {
  std::optional<ProgressLine> line;
  begin_line(arguments, line);
  line->update({"reading the recordings"});
  if (arguments.init) {
    write_first_job(arguments, stop_flag, line);
    return kUsable;
  }
  if (arguments.files.size() > 1)
    throw std::runtime_error(
        fmt::format("only one job file can be given; unexpected: {} (to create a job from "
                    "recordings, use --init)",
                    arguments.files[1]));
  const std::string& job = arguments.files.front();
  for (const char* ending :
       {".csv", ".txt", ".gz", ".mat", ".mcap", ".xlsx", ".wpilog", ".trace", ".jsonl"})
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
  FitArguments arguments;
  CLI::App app{"Fits the model of a robot axis to recordings, as described by a job file.",
               "fit-params"};
  add_options(app, arguments);
  return run_program(app, kFitShortHelp, argc, argv, [&] {
    complete(app, argc, argv, arguments);
    if (arguments.check) stop_flag.set();  // there is nothing to keep
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
