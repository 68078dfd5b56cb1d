#include "apps/first_job.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/command_line.h"
#include "base/text_table.h"
#include "init/machine_choice.h"
#include "io/results/output_folder.h"

namespace axisfit {
namespace {

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

}  // namespace

void write_first_job(const FitArguments& arguments, const StopFlag& stop,
                     std::optional<ProgressLine>& line) {
  namespace fs = std::filesystem;
  const fs::path folder = arguments.output.empty() ? "." : arguments.output;
  InitRequest request{.recordings = arguments.files,
                      .folder = folder.string(),
                      .axis = arguments.machine.empty() ? arguments.axis : arguments.machine,
                      .is_machine = !arguments.machine.empty(),
                      .gain = arguments.gain,
                      .answers = {.motor = arguments.motor}};
  for (const std::string& text : arguments.answers)
    request.answers.columns.push_back(read_answer(text));
  if (!arguments.rate.empty()) request.answers.rate = read_rate(arguments.rate);
  const RunContext context{.stop = &stop,
                           .progress = [&](const Progress& progress) { line->update(progress); }};
  MachineChoice choice;
  if (!request.axis.empty() || request.gain)
    choice.job = initial_job(request, context);
  else
    choice = choose_machine(request, context, arguments.threads.value_or(0));
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
  if (arguments.quiet) return;
  std::string text;
  for (const auto& [name, contents] : created.files) text += fmt::format("Wrote {}\n", path(name));
  text += tried_text(choice);
  if (!choice.is_explained)
    text +=
        "None of them explains the recordings to within ten times their noise: one mass was taken, "
        "for want of anything better\n";
  if (!created.guesses.empty()) text += "Guessed, please check\n";
  for (const std::string& guess : created.guesses) text += paragraph(guess, 2);
  const std::string job = path(created.files.back().first);
  print_error(text + fmt::format("Next: fit-params {} --check\n      fit-params {}\n", job, job));
}

}  // namespace axisfit
