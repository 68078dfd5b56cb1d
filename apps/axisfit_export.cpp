// axisfit-export FITTED.yaml --to TARGET: a fitted axis in the files of other tools.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "apps/command_line.h"
#include "apps/run_options.h"
#include "base/text_table.h"
#include "exports/export.h"
#include "fit/estimate/estimate.h"
#include "fit/judge/series.h"
#include "fit/predict/comparison.h"
#include "io/config/axis_file.h"
#include "io/config/job_file.h"

namespace {

using namespace axisfit;
namespace fs = std::filesystem;

struct Arguments {
  std::string axis, target, output, job, data;
};

constexpr const char* kShortHelp = R"(Usage: axisfit-export FITTED.yaml --to TARGET

Examples:
  axisfit-export fitted.yaml --to fmu2     a unit for co-simulation (or fmu3)
  axisfit-export fitted.yaml --to c        source in C, and for Simulink
  axisfit-export fitted.yaml --to mjcf     a model for MuJoCo

All options: axisfit-export --help
)";

constexpr const char* kExamples = R"(Examples:
  axisfit-export fitted.yaml --to fmu2
  axisfit-export fitted.yaml --to c --output controller
  axisfit-export fitted.yaml --to mjcf --job job.yaml

Exit codes: 0 exported, 2 bad input or an axis that the target cannot express.)";

/// Root of the mean square of the differences of two series.
double rms_between(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> differences(a.size());
  std::ranges::transform(a, b, differences.begin(), std::minus());
  return std::sqrt(mean_square(differences));
}

/// What the loss does to the job's recordings: by how much the simulation of them changes, and the
/// errors of both.
std::string losses_text(const Arguments& arguments, const Rig& rig, const Rig& carried) {
  const Job job = read_job_file(arguments.job, arguments.data).job;
  check_is_of_machine(rig, job, "--job " + arguments.job);
  const FitResult whole = evaluated(with_model(job, rig.model)),
                  rest = evaluated(with_model(job, carried.model));
  std::vector<std::vector<std::string>> rows{
      {"", "by what is lost", "error before", "after", "unit"}};
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    const SimulatedRecording &a = whole.recordings[r].free_running,
                             &b = rest.recordings[r].free_running;
    for (std::size_t m = 0; m < recording.measurements.size(); ++m) {
      const SignalInfo signal = info(recording.measurements[m].signal, job.vocabulary());
      const auto text = [](bool known, double value) {
        return known ? fmt::format("{:.3g}", value) : std::string("-");
      };
      rows.push_back(
          {fmt::format("{}: {}", recording.name, signal.name),
           text(a.finished && b.finished,
                a.finished && b.finished ? rms_between(a.simulated[m], b.simulated[m]) : 0.0),
           text(a.finished, whole.recordings[r].signals[m].rmse),
           text(b.finished, rest.recordings[r].signals[m].rmse), std::string(signal.unit)});
    }
  }
  using enum Alignment;
  return "What that does to the job's recordings, free running, rms\n" +
         format_table(rows, {left, right, right, right, left});
}

void run_command(const Arguments& arguments) {
  Diagnostics diagnostics;
  const auto rig = read_axis_file(arguments.axis, diagnostics);
  diagnostics.throw_if_any();
  const auto target = static_cast<ExportTarget>(
      std::ranges::find(kExportTargets, arguments.target) - std::begin(kExportTargets));
  const std::string stem = fs::path(arguments.axis).stem().string();
  const Export made = export_axis(
      *rig, target, stem, fmt::format("Exported by axisfit {} from {}", version(), arguments.axis));
  const fs::path folder = arguments.output.empty() ? "." : arguments.output;
  for (const auto& [name, contents] : made.files)
    refuse_to_overwrite((folder / name).string(), {arguments.axis});
  const std::string losses =
      arguments.job.empty() ? "" : losses_text(arguments, *rig, made.carried);
  fs::create_directories(folder);
  std::string text;
  for (const auto& [name, contents] : made.files) {
    const std::string path = (folder / name).lexically_normal().string();
    write_file(path, contents);
    text += fmt::format("Wrote {}\n", path);
  }
  if (made.lost.empty()) text += "All of the axis is in it.\n";
  for (const std::string& sentence : made.lost) text += paragraph(sentence);
  print(text + losses);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app{"Writes a fitted axis as other tools read it, and says what they cannot express.",
               "axisfit-export"};
  app.footer(kExamples);
  app.add_option("AXIS.yaml", arguments.axis, "axis file, such as the fitted.yaml of fit-params")
      ->required();
  const std::vector<std::string> targets(std::begin(kExportTargets), std::end(kExportTargets));
  app.add_option("--to", arguments.target,
                 "fmu2, fmu3: a unit for co-simulation by FMI 2.0 or 3.0; c: source in C, as an "
                 "S-function and a MEX function as well; mjcf: a model of MuJoCo; urdf: a joint "
                 "and a link; matlab: parameters and their covariance, as a function and a "
                 "MAT-file; frc: gains of a feed-forward in volts, as JSON")
      ->required()
      ->check(CLI::IsMember(targets))
      ->type_name("TARGET");
  app.add_option("-o,--output", arguments.output, "folder of the files; default: here")
      ->check(kNotEmpty)
      ->type_name("FOLDER");
  auto* job =
      app.add_option("--job", arguments.job, "say what is lost by the recordings of this job")
          ->check(kNotEmpty)
          ->type_name("JOB.yaml");
  app.add_option("--data", arguments.data, "folder of the recordings, if not that of the job file")
      ->needs(job)
      ->check(kNotEmpty)
      ->type_name("FOLDER");
  return run_program(app, kShortHelp, argc, argv, [&] {
    run_command(arguments);
    return 0;
  });
}
