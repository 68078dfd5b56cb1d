#include "apps/fit_arguments.h"

#include <fmt/format.h>

#include <sstream>

#include "apps/command_line.h"
#include "init/starter_axis.h"
#include "sim/model.h"

namespace axisfit {
namespace {

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

std::vector<std::string> split(const std::string& names) {
  std::vector<std::string> list;
  std::istringstream stream(names);
  for (std::string name; std::getline(stream, name, ',');) list.push_back(name);
  return list;
}

/// The command line, as one would type it.
std::string command_line_of(int argc, char** argv) {
  std::string line = "fit-params";
  for (int i = 1; i < argc; ++i) line += " " + quoted(argv[i]);
  return line;
}

}  // namespace

void add_options(CLI::App& app, FitArguments& arguments) {
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
  auto* profile =
      app.add_flag("--profile{all}", arguments.profiles,
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

  auto* compare =
      app.add_flag("--compare{-}", arguments.compared,
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
  const Quantity& gain = quantity_list(Joint::revolute)[quantity_index("K_f")].quantity;
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
                 "given several times; without a unit, this is inferred")
      ->needs(init)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->type_name("SIGNAL=COLUMN:UNIT");
  app.add_option("--rate", arguments.rate,
                 "with --init: samples a second, such as \"1 kHz\", of recordings without a column "
                 "of times")
      ->needs(init)
      ->check(kNotEmpty)
      ->type_name("RATE");
  app.add_option("--motor", arguments.motor,
                 "with --init: which of several axes in one file, by the number or word that the "
                 "names of its columns have in common")
      ->needs(init)
      ->check(kNotEmpty)
      ->type_name("NAME");

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
}

void complete(const CLI::App& app, int argc, char** argv, FitArguments& arguments) {
  arguments.command = command_line_of(argc, argv);
  arguments.profiled = split(arguments.profiles);
  arguments.options.predict = app.count("--predict") > 0;
  arguments.options.compare = app.count("--compare") > 0;
  if (arguments.compared != "-") arguments.others = split(arguments.compared);
}

std::string quoted(const std::string& path) {
  if (!path.empty() && path.find_first_of(" \t\n'\"\\$&;|<>()*?[]{}`!#~") == std::string::npos)
    return path;
  std::string text = path;
  for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 4)
    text.replace(at, 1, "'\\''");
  return "'" + text + "'";
}

}  // namespace axisfit
