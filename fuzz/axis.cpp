// Axis files, and motion files for the axis: what is read can be written, and reads back the same
// to the last bit.
#include <bit>
#include <cstdint>

#include "fuzz/check.h"
#include "io/config/axis_file.h"
#include "io/config/motion_file.h"

namespace axisfit::fuzz {
namespace {

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same(Rig a, Rig b) {
  const Structure &s = a.model.structure, &t = b.model.structure;
  bool equal = a.name == b.name && s.drive == t.drive && s.transmission == t.transmission &&
               s.effects == t.effects;
  const auto p = members(a.model), q = members(b.model);
  for (std::size_t i = 0; i < p.size(); ++i)
    equal = equal && (same(*p[i], *q[i]) || !is_used(quantity_list()[i], s));
  std::vector<double> settings;
  visit_settings(a.model.controller, [&](const Quantity&, double x) { settings.push_back(x); });
  std::size_t setting = 0;
  visit_settings(b.model.controller,
                 [&](const Quantity&, double x) { equal = equal && same(x, settings[setting++]); });
  return equal && a.noise == b.noise;
}

void check_motion(const Folder& folder, const MotionFile& file, const Rig& rig) {
  if (std::holds_alternative<RecordedMotion>(file.motion)) return;
  const Vocabulary vocabulary = vocabulary_of(rig.model.structure);
  const std::string text = format_motion_file(file, "Motion.", vocabulary);
  try {
    const MotionFile again = read_motion_file(folder.write("again.yaml", text), rig);
    require(format_motion_file(again, "Motion.", vocabulary) == text,
            "a motion changes when written", text);
  } catch (const ConfigError& error) {
    require(false, "a motion is not read again", text + error.what());
  }
}

}  // namespace

void check_input(const Folder& folder, std::string_view input) {
  folder.clear();
  for (const auto& [name, contents] : files_of(input)) folder.write(name, contents);
  std::optional<Rig> rig;
  refusable([&] {
    Diagnostics diagnostics;
    rig = read_axis_file(folder.path("axis.yaml"), diagnostics);
    diagnostics.throw_if_any();
    require(rig.has_value(), "an axis is refused without a word");
  });
  if (!rig) return;
  require(model_error(rig->model).empty(), "an axis was read that cannot be simulated");
  const std::string text = format_axis_file(*rig, "Axis.");
  Diagnostics diagnostics;
  const auto again = read_axis_file(folder.write("again.yaml", text), diagnostics);
  require(again.has_value(), "an axis is not read again", text);
  require(same(*rig, *again), "an axis changes when written", text);
  if (!std::filesystem::exists(folder.path("motion.yaml"))) return;
  refusable(
      [&] { check_motion(folder, read_motion_file(folder.path("motion.yaml"), *rig), *rig); });
}

}  // namespace axisfit::fuzz
