#include "apps/run_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <variant>

#include "base/units.h"
#include "io/config/axis_file.h"
#include "io/config/channels.h"
#include "io/config/motion_file.h"
#include "report/text/names.h"

namespace axisfit {

void check_is_of_machine(const Rig& rig, const Job& job, const std::string& where) {
  const Structure &own = job.model.structure, &other = rig.model.structure;
  if (vocabulary_of(own) != vocabulary_of(other))
    throw std::runtime_error(
        fmt::format("{}: joint or unit of the command are not those of the job's axis", where));
  const auto name = [](const Channel& channel) { return channel.name; };
  const ChannelList &channels = channels_of(own), &others = channels_of(other);
  if (others.size() > channels.size() ||
      !std::ranges::equal(others, std::span(channels).first(others.size()), {}, name, name))
    throw std::runtime_error(
        fmt::format("{}: its channels are not those of the job, in the same order", where));
}

std::vector<OtherModel> models_of(const std::vector<std::string>& axis_files, const Job& job) {
  std::vector<OtherModel> models;
  for (const std::string& file : axis_files) {
    Diagnostics diagnostics;
    auto rig = read_axis_file(file, diagnostics);
    diagnostics.throw_if_any();
    check_is_of_machine(*rig, job, "--compare " + file);
    models.push_back({file, rig->model, rig->uncertainty});
  }
  return models;
}

Tolerance tolerance_of(const std::string& text, const Job& job) {
  std::size_t end = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &end);
  } catch (const std::exception&) {
    end = 0;
  }
  const std::string unit = text.substr(std::min(text.find_first_not_of(' ', end), text.size()));
  if (end == 0 || !(value > 0.0) || !std::isfinite(value) || unit.empty())
    throw std::runtime_error(
        fmt::format("--within '{}': write a number above zero and its unit, such as 1mm", text));
  for (const Recording& r : job.recordings)
    for (const Measurement& m : r.measurements)
      if (std::holds_alternative<double>(unit_factor(unit, info(m.signal, job.vocabulary()).unit)))
        return {value, unit};
  throw std::runtime_error(
      fmt::format("--within '{}': no signal of the job can be given in {}", text, unit));
}

void set_profiles(const std::vector<std::string>& names, const Job& job, RunOptions& options) {
  std::vector<std::string> known;
  for (const FreeParameter& p : job.free) known.push_back(name_of(job, p));
  for (const std::string& name : names) {
    if (name == "all") {
      options.profile_all = true;
      continue;
    }
    const auto at = std::ranges::find(known, name);
    if (at == known.end())
      throw std::runtime_error(
          fmt::format("--profile: {} is not a free parameter; free parameters are {}", name,
                      fmt::join(known, ", ")));
    // After "all" there is none left, and the order of the profiles stays that of the names.
    if (!options.profile_all)
      options.profiles.push_back(job.free[static_cast<std::size_t>(at - known.begin())].id());
  }
}

MotionToPredict motion_of(const std::string& path, const Rig& rig) {
  const MotionFile file = read_motion_file(path, rig);
  return {path, file.motion, file.duration, rig};
}

}  // namespace axisfit
