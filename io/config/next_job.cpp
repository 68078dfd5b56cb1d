#include "io/config/next_job.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>

#include "base/units.h"
#include "fit/estimate/kalman_gain.h"
#include "io/config/yaml_text.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

/// The same file from another folder.
std::string moved(const std::string& file, const fs::path& from, const fs::path& to) {
  if (fs::path(file).is_absolute()) return file;
  return fs::proximate(fs::absolute(from / file), fs::absolute(to)).generic_string();
}

bool is_free(const Job& job, const FreeParameter& p) {
  return std::ranges::any_of(job.free, [&](const FreeParameter& other) {
    return other.quantity == p.quantity && other.recording == p.recording;
  });
}

/// What an effect brought, with the bounds that it had.
YAML::Node free_entry(const Job& job, const FreeParameter& p) {
  const std::string_view unit = job.entry(p.quantity).quantity.unit;
  YAML::Node entry(YAML::NodeType::Map);
  for (const double bound : {p.lower, p.upper}) entry["bounds"].push_back(with_unit(bound, unit));
  for (const FreeParameter& other : job.free)
    if (other.quantity == p.quantity && other.recording)
      entry["per_recording"].push_back(job.recordings[*other.recording].name);
  entry.SetStyle(YAML::EmitterStyle::Flow);
  return entry;
}

}  // namespace

std::string next_job_text(const JobFile& declared, const Job& reached, const std::string& path,
                          const std::string& data_directory, const std::string& folder,
                          const std::string& axis_name, const std::string& comment_text) {
  YAML::Node job = YAML::Load(declared.text);
  const fs::path data =
      data_directory.empty() ? fs::path(path).parent_path() : fs::path(data_directory);
  job["axis"] = axis_name;
  // The axis has them, with their values.
  job.remove("effects");
  for (std::size_t r = 0; r < reached.recordings.size(); ++r) {
    YAML::Node recording = job["recordings"][r];
    if (const Role role = reached.recordings[r].role; role != declared.job.recordings[r].role)
      recording["role"] = role == Role::fit ? "fit" : "validate";
    recording["file"] = moved(recording["file"].Scalar(), data, folder);
    for (const char* columns : {"signals", "channels"})
      if (recording[columns])
        for (auto column : recording[columns])
          if (YAML::Node file = column.second["file"]) file = moved(file.Scalar(), data, folder);
  }
  if (had_to_track(declared.job, reached)) {
    YAML::Node fit = job["fit"], observer;
    for (const char* key : {"horizon", "initial_observer_gain"}) fit.remove(key);
    observer["fixed"] = with_unit(given_gain(reached.options.criterion), "1/s");
    fit["observer"] = observer;
  }
  for (auto entry : job["free"])
    if (entry.second.IsMap()) entry.second.remove("initial");
  for (const FreeParameter& p : reached.free)
    if (!is_free(declared.job, p))
      job["free"][reached.entry(p.quantity).name] = free_entry(reached, p);
  YAML::Emitter out;
  out << job;
  return comment(comment_text, 0) + out.c_str() + "\n";
}

}  // namespace axisfit
