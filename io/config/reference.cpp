#include "io/config/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <vector>

#include "io/config/axis_file.h"
#include "io/config/fleet_file.h"
#include "io/config/job_file.h"
#include "io/config/machine_file.h"
#include "io/config/motion_file.h"
#include "io/config/schema.h"

namespace axisfit {
namespace {

constexpr std::string_view kBegin = "<!-- keys: ", kBeginEnd = " -->\n";
constexpr std::string_view kEnd = "<!-- end of keys -->\n";

std::string row(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += fmt::format(" {} |", cell);
  return text + "\n";
}

std::string code(const std::string& name) { return '`' + name + '`'; }

/// The cells of a key behind its name.
std::vector<std::string> cells_of(const Key& key) {
  return {value_text(key.form),
          key.default_value.empty() ? default_description(key) : code(key.default_value),
          key.used_by.empty() ? "all" : key.used_by, meaning_text(key)};
}

/// A table of the keys in Markdown. Keys in a row that differ in nothing but their name share one
/// line. A column says which axes have a key, unless all have all.
std::string table(const Section& keys) {
  const bool all_used = std::ranges::all_of(keys, &std::string::empty, &Key::used_by);
  const auto line = [&](const std::string& name, std::vector<std::string> cells) {
    if (all_used) cells.erase(cells.begin() + 2);
    cells.insert(cells.begin(), name);
    return row(cells);
  };
  std::string text = line("key", {"value", "default", "used by", "meaning"});
  text += line("---", {"---", "---", "---", "---"});
  for (auto first = keys.begin(); first != keys.end();) {
    const auto next = std::find_if(
        first, keys.end(), [&](const Key& key) { return cells_of(key) != cells_of(*first); });
    const auto last = std::prev(next);
    text += line(first == last ? code(first->name)
                               : fmt::format("{} ... {}", code(first->name), code(last->name)),
                 cells_of(*first));
    first = next;
  }
  return text;
}

/// A section with what differs between the signals said in words.
Section of_the_signal(Section keys) {
  const std::string unit = "unit of the signal";
  for (Key& key : keys) {
    auto* amount = std::get_if<NumberWithUnit>(&key.form);
    if (amount == nullptr || (key.name != "bias" && key.name != "noise")) continue;
    amount->description = unit + value_text(*amount).substr(amount->unit.size());
    key.default_value = "0";
  }
  return keys;
}

/// The parameters of all effects, under their full names.
Section effect_parameters() {
  Section all;
  for (const Key& effect : keys_below(axis_keys(kSourceVocabulary), "effects")) {
    for (const NamedEntry& entry : std::get<Map>(effect.form).named)
      all.push_back(
          Key::optional(effect.name + ".CHANNEL", entry.form, DefaultText{"0"}, effect.meaning));
    for (Key parameter : std::get<Map>(effect.form).keys) {
      parameter.name = effect.name + "." + parameter.name;
      parameter.used_by = effect.used_by;
      all.push_back(std::move(parameter));
    }
  }
  return all;
}

/// What a revolute joint has under another name or in another unit.
Section on_a_revolute_joint() {
  Section all;
  for (const QuantityEntry& sliding : quantity_list()) {
    const QuantityEntry& turning = quantity_list(Joint::revolute)[sliding.index];
    const bool is_same =
        turning.name == sliding.name && turning.quantity.unit == sliding.quantity.unit;
    if (is_same || sliding.signal || sliding.quantity.channel) continue;
    Key key = Key::of(turning.quantity, turning.name);
    key.used_by.clear();
    // Curves have many that are one line.
    const bool is_curve = sliding.quantity.symbol.starts_with("c1");
    if (turning.name != sliding.name)
      key.meaning += fmt::format(", `{}` of a prismatic joint",
                                 turning.quantity.symbol == sliding.quantity.symbol || is_curve
                                     ? sliding.group
                                     : sliding.name);
    all.push_back(std::move(key));
  }
  return all;
}

/// All tables by the name that the pages call them by.
std::map<std::string, Section> tables() {
  const Section& axis = axis_keys(kSourceVocabulary);
  const Section& job = job_keys();
  const Section& recording =
      std::get<Map>(std::get<List>(find_key(job, "recordings").form).of[0]).keys;
  const Section& signals = keys_below(recording, "signals");
  std::map<std::string, Section> tables{
      {"job", job},
      {"job.recordings", recording},
      {"job.recordings.signals", signals},
      {"job.recordings.signals.SIGNAL", keys_below(signals, "position")},
      {"job.recordings.signals.SIGNAL.filter",
       keys_below(keys_below(signals, "position"), "filter")},
      {"job.free.NAME", keys_below(keys_below(job, "free"), "M")},
      {"job.fit", keys_below(job, "fit")},
      {"job.axes", axes_job_keys()},
      {"job.limits", keys_below(job, "limits")},
      {"axis", axis},
      {"axis.parameters", keys_below(axis, "parameters")},
      {"axis.effects", effect_parameters()},
      {"axis.initial", keys_below(axis, "initial")},
      {"axis.instruments.SIGNAL",
       of_the_signal(keys_below(keys_below(axis, "instruments"), "position"))},
      {"axis.controller", keys_below(axis, "controller")},
      {"axis.revolute", on_a_revolute_joint()},
      {"fleet", fleet_keys()},
      {"machine", machine_keys()},
      {"machine.axes.NAME", machine_axis_keys()},
      {"motion", motion_keys()}};
  for (const std::string& type : std::get<Choice>(find_key(motion_keys(), "type").form).names())
    tables["motion." + type] = motion_keys(type, kSourceVocabulary);
  return tables;
}

/// JSON with a line for what is short, so that a change of one key is a change of one line.
std::string lines_of(const nlohmann::ordered_json& json, const std::string& indent = "") {
  constexpr std::size_t kShort = 250;
  const std::string line = json.dump();
  if (line.size() <= kShort || !json.is_structured()) return line;
  std::string text(1, line.front());
  for (const auto& [key, value] : json.items()) {
    if (text.size() > 1) text += ',';
    text += "\n" + indent + " ";
    if (json.is_object()) text += nlohmann::json(key).dump() + ": ";
    text += lines_of(value, indent + " ");
  }
  return text + "\n" + indent + line.back();
}

std::string contents_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(fmt::format("cannot read {}", path.string()));
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

std::map<std::string, std::string> reference_files(const std::string& project) {
  std::map<std::string, std::string> files;
  const auto add_schema = [&](const char* of, const nlohmann::ordered_json& schema) {
    files[fmt::format("configs/schema/{}.schema.json", of)] = lines_of(schema) + "\n";
  };
  add_schema("job", job_schema());
  add_schema("axis", axis_schema());
  add_schema("motion", motion_schema());
  add_schema("machine", machine_schema());
  add_schema("fleet", fleet_schema());

  const std::map<std::string, Section> all = tables();
  std::set<std::string> shown;
  for (const char* page : {"docs/job-file.md", "docs/axis-file.md", "docs/motion-file.md",
                           "docs/machine-file.md", "docs/fleet.md"}) {
    const std::string old = contents_of(std::filesystem::path(project) / page);
    std::string made;
    std::size_t at = 0;
    for (std::size_t begin; (begin = old.find(kBegin, at)) != std::string::npos;) {
      const std::size_t name_at = begin + kBegin.size();
      const std::size_t name_end = old.find(kBeginEnd, name_at);
      const std::size_t end = old.find(kEnd, begin);
      if (name_end == std::string::npos || end == std::string::npos)
        throw std::runtime_error(fmt::format("{}: a table of keys has no end", page));
      const std::string name = old.substr(name_at, name_end - name_at);
      const auto found = all.find(name);
      if (found == all.end())
        throw std::runtime_error(fmt::format("{}: there is no table '{}'", page, name));
      shown.insert(name);
      made += old.substr(at, name_end + kBeginEnd.size() - at) + table(found->second);
      at = end;
    }
    files[page] = made + old.substr(at);
  }
  for (const auto& [name, keys] : all)
    if (!shown.contains(name))
      throw std::runtime_error(fmt::format("no page in docs/ shows the table '{}'", name));
  return files;
}

}  // namespace axisfit
