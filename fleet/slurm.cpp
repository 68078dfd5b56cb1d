#include "fleet/slurm.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "base/plain_text.h"
#include "io/results/output_folder.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

/// A word for the shell, whatever is in it.
std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string head(const std::string& plan, const SlurmOptions& options, const char* name) {
  std::string text = fmt::format(
      "#!/bin/sh\n#SBATCH --job-name=axisfit-{0}\n#SBATCH --output={1}/logs/{0}-%A-%a.log\n"
      "#SBATCH --requeue\n#SBATCH --open-mode=append\n#SBATCH --cpus-per-task=1\n"
      "#SBATCH --mem={2}M\n#SBATCH --time={3}\n",
      name, plan, options.megabytes, options.minutes);
  if (!options.partition.empty()) text += "#SBATCH --partition=" + options.partition + "\n";
  return text;
}

/// What a command prints. Throws with it when it fails.
std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen((command + " 2>&1").c_str(), "r"),
                                                   [](FILE*) { return 0; });
  if (!pipe) throw std::runtime_error("no shell can be started");
  std::string text;
  std::array<char, 256> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) text += buffer.data();
  if (::pclose(pipe.get()) != 0)
    throw std::runtime_error("sbatch: " + sanitized(text.substr(0, text.find('\n'))));
  return text.substr(0, text.find_first_of("\n;"));
}

}  // namespace

std::string array_script(const std::string& plan, const SlurmOptions& options) {
  return head(plan, options, "work") +
         fmt::format("#SBATCH --array=0-{}\nexec {} work {} --shard \"$SLURM_ARRAY_TASK_ID/{}\"\n",
                     options.tasks - 1, shell_word(options.program), shell_word(plan),
                     options.tasks);
}

std::string merge_script(const std::string& plan, const SlurmOptions& options) {
  return head(plan, options, "merge") +
         fmt::format("exec {} merge {}\n", shell_word(options.program), shell_word(plan));
}

std::string submit(const std::string& folder, const SlurmOptions& options) {
  const fs::path plan = fs::absolute(folder);
  if (plan.string().find_first_of(" \t\n\"'%\\") != std::string::npos)
    throw std::runtime_error(in_quotes(plan.string()) +
                             ": Slurm takes no folder with such a character");
  fs::create_directories(plan / "logs");
  write_file(plan / "work.sh", array_script(plan.string(), options));
  write_file(plan / "merge.sh", merge_script(plan.string(), options));
  const std::string array = output_of("sbatch --parsable " + shell_word(plan / "work.sh"));
  // After all tasks have ended, however: what is missing is told by the merge.
  const std::string merge =
      output_of("sbatch --parsable --dependency=afterany:" + array + " --kill-on-invalid-dep=yes " +
                shell_word(plan / "merge.sh"));
  return fmt::format("{} (array of {}), {} (merge)", array, options.tasks, merge);
}

}  // namespace axisfit
