// fit-params --init: the job that it makes for a recording can be read.
#include <optional>

#include "fuzz/check.h"
#include "init/init_job.h"
#include "init/recording_guess.h"
#include "io/config/job_file.h"

namespace axisfit::fuzz {

void check_input(const Folder& folder, std::string_view input) {
  folder.clear();
  const std::string path = folder.write("data.csv", input);
  bool is_long = false;
  refusable([&] {
    // A long one is simulated for long, which is no finding.
    constexpr double kLongest = 10.0;
    const std::vector<double> times = guess_recording(RecordingFile(path), path).time.values;
    is_long = times.back() - times.front() > kLongest;
  });
  if (is_long) return;
  std::optional<InitialJob> made;
  refusable([&] { made = initial_job({.recordings = {path}, .folder = folder.path("")}); });
  if (!made) return;
  for (const std::string& guess : made->guesses) require_message(guess);
  for (const auto& [name, contents] : made->files) folder.write(name, contents);
  try {
    read_job_file(folder.path(made->files.back().first));
  } catch (const ConfigError& error) {
    require(false, "the job of --init is refused", error.what());
  }
}

}  // namespace axisfit::fuzz
