// fit-params --init: the job that it makes for a recording can be read.
#include <cstdint>
#include <optional>

#include "apps/init_job.h"
#include "apps/job_file.h"
#include "apps/recording_guess.h"
#include "fuzz/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace axisfit;
  using namespace axisfit::fuzz;
  static const Folder folder;
  folder.clear();
  const std::string path = folder.write("data.csv", {reinterpret_cast<const char*>(data), size});
  bool is_long = false;
  refusable([&] {
    // A long one is simulated for long, which is no finding.
    constexpr double kLongest = 10.0;
    const std::vector<double> times = guess_recording(RecordingFile(path), path).time.values;
    is_long = times.back() - times.front() > kLongest;
  });
  if (is_long) return 0;
  std::optional<InitialJob> made;
  refusable([&] { made = initial_job({path}, "", folder.path("")); });
  if (!made) return 0;
  for (const std::string& guess : made->guesses) require_message(guess);
  for (const auto& [name, contents] : made->files) folder.write(name, contents);
  try {
    read_job_file(folder.path(made->files.back().first));
  } catch (const ConfigError& error) {
    require(false, "the job of --init is refused", error.what());
  }
  return 0;
}
