// Jobs with their axes and recordings: a job that is read is one that can be fitted.
#include <algorithm>
#include <cmath>

#include "fuzz/check.h"
#include "io/config/job_file.h"

namespace axisfit::fuzz {
namespace {

bool finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
}

bool increases(const std::vector<double>& times) {
  return std::ranges::adjacent_find(times, std::greater_equal()) == times.end();
}

void check_recording(const Recording& r) {
  require(r.times.size() >= 10 && finite(r.times) && increases(r.times), "times are no times");
  require(!r.command.times.empty() && finite(r.command.values), "the command is no command");
  require(finite(r.command.times) && increases(r.command.times), "the command has no times");
  require(!r.name.empty(), "a recording has no name");
  require(!r.measurements.empty(), "nothing is measured");
  for (const Measurement& m : r.measurements) {
    require(m.values.size() == r.times.size() && finite(m.values), "values are missing");
    require(std::isfinite(m.sigma) && m.sigma > 0.0, "a sigma is not above zero");
    require(m.excluded.empty() || m.excluded.size() == r.times.size(), "samples are lost");
    require(m.uninformative.empty() || m.uninformative.size() == r.times.size(),
            "samples are lost");
  }
}

void check_job(const JobFile& file) {
  const Job& job = file.job;
  require(model_error(job.model).empty(), "the model cannot be simulated");
  require(!job.free.empty(), "nothing is free");
  require(!job.recordings.empty(), "nothing is recorded");
  for (const Recording& r : job.recordings) check_recording(r);
  for (const FreeParameter& p : job.free) {
    require(p.lower <= p.initial && p.initial <= p.upper, "an initial value is out of bounds");
    require(std::isfinite(p.initial), "an initial value is not finite");
    require(p.scale != Scale::logarithmic || p.lower > 0.0,
            "a logarithmic bound is not above zero");
    require(!p.prior || (std::isfinite(p.prior->mean) && p.prior->sigma > 0.0), "a prior is none");
    require(!p.recording || *p.recording < job.recordings.size(), "a recording is missing");
    require(is_used(quantity_list()[p.quantity], job.model.structure), "a free quantity is unused");
  }
}

}  // namespace

void check_input(const Folder& folder, std::string_view input) {
  // What these hold is not up to the input, and some never end.
  for (const char* device : {"/dev", "/proc", "/sys"})
    if (input.find(device) != input.npos) return;
  folder.clear();
  for (const auto& [name, contents] : files_of(input))
    if (!is_hdf5(contents)) folder.write(name, contents);
  refusable([&] { check_job(read_job_file(folder.path("job.yaml"))); });
}

}  // namespace axisfit::fuzz
