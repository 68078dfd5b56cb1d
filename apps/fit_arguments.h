// The command line of fit-params.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fit/run.h"

namespace axisfit {

/// What the command line of fit-params says.
struct FitArguments {
  std::string command;             ///< as one would type it
  std::vector<std::string> files;  ///< the job, or the recordings to make one for
  std::string data;
  std::string output;
  std::string from;
  std::string axis, machine;
  std::optional<double> gain;         ///< N/V
  std::vector<std::string> answers;   ///< what columns are
  std::string rate, motor;            ///< of samples without times; which of several axes
  std::string profiles, compared;     ///< names with commas, as they were given
  std::vector<std::string> profiled;  ///< names of parameters
  std::vector<std::string> others;    ///< axis files to compare with
  std::string motion;                 ///< motion file to predict; "-": none
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

inline constexpr const char* kFitShortHelp = R"(Usage: fit-params [OPTIONS] JOB.yaml

Examples:
  fit-params --init step.csv levels.csv    create a job from recordings
  fit-params job.yaml --check              see what the recordings tell
  fit-params job.yaml --output results     fit

All options: fit-params --help
)";

/// Adds the options of fit-params, which fill the arguments; these must outlive the app.
void add_options(CLI::App& app, FitArguments& arguments);

/// Completes the arguments, once they are parsed, from those of main().
void complete(const CLI::App& app, int argc, char** argv, FitArguments& arguments);

/// A path as a shell reads it.
std::string quoted(const std::string& path);

}  // namespace axisfit
