#include "apps/axis_file.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "apps/units.h"
#include "sim/suggest.h"

namespace axisfit {
namespace {

const std::vector<std::string> kDrives{"velocity_loop", "current_source", "force_source"};
const std::vector<std::string> kTransmissions{"backlash", "rigid"};

std::string describe(const Structure& structure) {
  return fmt::format("drive {} and transmission {}",
                     kDrives[static_cast<std::size_t>(structure.drive)],
                     kTransmissions[static_cast<std::size_t>(structure.transmission)]);
}

void read_parameters(const ConfigNode& node, Model<double>& model) {
  ConfigMap map(node);
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list()) {
    if (!entry.group.empty()) continue;
    const Quantity& quantity = entry.quantity;
    double& value = *member[entry.index];
    if (!is_used(entry, model.structure)) {
      if (const auto given = map.optional(quantity.symbol))
        given->error(fmt::format("{} has no part in an axis with {}: remove it", quantity.symbol,
                                 describe(model.structure)));
      // Values with which the equations leave the part out.
      value = entry.quantity.symbol == "r_g" ? 1.0 : 0.0;
      continue;
    }
    const bool compulsory = std::isnan(quantity.standard);
    const auto given = compulsory ? map.required(quantity.symbol) : map.optional(quantity.symbol);
    value = quantity.standard;
    if (given) value = read_value(*given, quantity).value_or(quantity.upper);
  }
  map.finish();
}

void read_initial(const ConfigNode& node, Model<double>& model) {
  ConfigMap map(node);
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list())
    if (entry.group == "initial" && is_used(entry, model.structure))
      if (const auto given = map.optional(entry.quantity.symbol))
        *member[entry.index] = read_value(*given, entry.quantity).value_or(0.0);
  map.finish();
}

void read_instruments(const ConfigNode& node, Rig& rig) {
  ConfigMap map(node);
  for (const SignalInfo& signal : kSignalTable) {
    const auto given = map.optional(signal.name);
    if (!given) continue;
    ConfigMap instrument(*given);
    const std::vector<double*> member = members(rig.model);
    for (const QuantityEntry& entry : quantity_list())
      if (entry.group == signal.name)
        if (const auto value = instrument.optional(entry.quantity.symbol))
          *member[entry.index] =
              read_value(*value, entry.quantity).value_or(entry.quantity.standard);
    if (const auto noise = instrument.optional("noise"))
      rig.noise[index_of(signal.signal)] = noise->as_quantity(signal.unit, 0.0, 1e6).value_or(0.0);
    instrument.finish();
  }
  map.finish();
}

void read_controller(const ConfigNode& node, ControllerSettings& settings) {
  ConfigMap map(node);
  const auto read = [&](std::string_view key, std::string_view unit, double lower, double upper,
                        double& value) {
    if (const auto given = map.optional(key))
      value = given->as_quantity(unit, lower, upper).value_or(value);
  };
  read("period", "s", 1e-5, 1.0, settings.period);
  read("track_period", "s", 1e-5, 10.0, settings.track_period);
  read("k_ff", "1", 0.0, 100.0, settings.k_ff);
  read("k_p", "1/s", 0.0, 1e5, settings.k_p);
  read("k_i", "1/s^2", 0.0, 1e6, settings.k_i);
  read("gain", "V s/m", 1e-3, 1e6, settings.gain);
  read("limit", "V", 1e-3, 1e4, settings.limit);
  read("counts_per_revolution", "1", 0.0, 1e9, settings.counts_per_revolution);
  map.finish();
}

}  // namespace

std::optional<double> read_value(const ConfigNode& node, const Quantity& quantity) {
  return node.as_quantity(quantity.unit, quantity.lower, quantity.upper);
}

const QuantityEntry* quantity_named(const ConfigNode& key, const Structure& structure) {
  const std::string name = key.text();
  const QuantityEntry* entry = find_quantity(name);
  if (entry != nullptr && is_used(*entry, structure)) return entry;
  if (entry != nullptr) {
    const bool parameter = entry->group.empty() || entry->group == "initial";
    key.error(
        parameter
            ? fmt::format("{} has no part in this axis: its drive or transmission leaves it out",
                          name)
            : fmt::format("{} needs the effect: add it to the axis or job, as in 'effects: {{{}: "
                          "{{{}: ...}}}}'",
                          name, entry->group, entry->quantity.symbol));
    return nullptr;
  }
  std::vector<std::string> names;
  for (const QuantityEntry& e : quantity_list())
    if (is_used(e, structure)) names.push_back(e.name);
  const std::string near = nearest(name, names);
  key.error(fmt::format("there is no quantity '{}'; {}", name,
                        near.empty()
                            ? "the axis has its parameters, effect.parameter, signal.gain, "
                              "bias, lag and delay, and initial.y0 ... initial.y6"
                            : fmt::format("did you mean '{}'?", near)));
  return nullptr;
}

void read_effects(const ConfigNode& node, Model<double>& model) {
  ConfigMap map(node);
  visit_effects(model.effects, [&](std::size_t index, auto& effect) {
    const auto given = map.optional(effect.name);
    if (!given) return;
    model.structure.effects.set(index);
    ConfigMap parameters(*given);
    bool used = false;
    effect.visit(effect, [&](const Quantity& quantity, double& value) {
      used = used || is_used(*find_quantity(full_name(effect.name, quantity)), model.structure);
      const bool compulsory = std::isnan(quantity.standard);
      const auto text =
          compulsory ? parameters.required(quantity.symbol) : parameters.optional(quantity.symbol);
      value = compulsory ? 0.0 : quantity.standard;
      if (text) value = read_value(*text, quantity).value_or(value);
    });
    parameters.finish();
    if (!used)
      given->error(fmt::format("{} has no part in an axis with {}: remove it", effect.name,
                               describe(model.structure)));
  });
  map.finish();
}

std::optional<Rig> read_axis_file(const std::string& path, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.sorted().size();
  const auto root = ConfigNode::load(path, diagnostics);
  if (!root) return std::nullopt;
  Rig rig;
  ConfigMap map(*root);
  if (const auto name = map.optional("name")) rig.name = name->as_string().value_or("");
  std::optional<std::size_t> drive, transmission;
  if (const auto given = map.required("drive")) drive = given->as_choice(kDrives);
  if (const auto given = map.required("transmission"))
    transmission = given->as_choice(kTransmissions);
  rig.model.structure.drive = static_cast<Drive>(drive.value_or(0));
  rig.model.structure.transmission = static_cast<Transmission>(transmission.value_or(0));
  if (const auto effects = map.optional("effects")) read_effects(*effects, rig.model);
  const auto parameters = map.required("parameters");
  const auto initial = map.optional("initial");
  if (drive && transmission) {  // what quantities an axis has depends on them
    if (parameters) read_parameters(*parameters, rig.model);
    if (initial) read_initial(*initial, rig.model);
  }
  if (const auto instruments = map.optional("instruments")) read_instruments(*instruments, rig);
  // Without a pinion there is no telling how far a count is, unless it is said.
  if (!is_used(*find_quantity("r_g"), rig.model.structure))
    rig.controller.counts_per_revolution = 0.0;
  if (const auto controller = map.optional("controller"))
    read_controller(*controller, rig.controller);
  map.finish();
  if (diagnostics.sorted().size() > before) return std::nullopt;
  if (const std::string reason = refusal(rig.model); !reason.empty()) {
    parameters->error(reason);
    return std::nullopt;
  }
  return rig;
}

std::string format_axis_file(const Rig& rig, const std::string& comment) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  if (!rig.name.empty()) out << YAML::Key << "name" << YAML::Value << rig.name;
  const Structure& structure = rig.model.structure;
  out << YAML::Key << "drive" << YAML::Value << kDrives[static_cast<std::size_t>(structure.drive)];
  out << YAML::Key << "transmission" << YAML::Value
      << kTransmissions[static_cast<std::size_t>(structure.transmission)];

  // The quantities in use by group, in the order of the list; those at their standard value are
  // left out where that is the custom (instruments, initial state).
  std::map<std::string, std::vector<std::pair<std::string, std::string>>> groups;
  Model<double> model = rig.model;
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list()) {
    const double value = *member[entry.index];
    const bool custom = entry.group == "initial" || signal_by_name(entry.group).has_value();
    if (!is_used(entry, structure) || (custom && value == entry.quantity.standard)) continue;
    groups[entry.group].emplace_back(entry.quantity.symbol, with_unit(value, entry.quantity.unit));
  }
  for (const SignalInfo& signal : kSignalTable)
    if (const double noise = rig.noise[index_of(signal.signal)]; noise > 0.0)
      groups[std::string(signal.name)].emplace_back("noise", with_unit(noise, signal.unit));

  const auto emit = [&](const std::string& key, const std::string& group) {
    out << YAML::Key << key << YAML::Value << YAML::BeginMap;
    for (const auto& [symbol, text] : groups[group])
      out << YAML::Key << symbol << YAML::Value << text;
    out << YAML::EndMap;
  };
  emit("parameters", "");
  if (structure.effects.any()) {
    out << YAML::Key << "effects" << YAML::Value << YAML::BeginMap;
    visit_effects(model.effects, [&](std::size_t index, const auto& effect) {
      if (structure.effects[index]) emit(std::string(effect.name), std::string(effect.name));
    });
    out << YAML::EndMap;
  }
  if (groups.contains("initial")) emit("initial", "initial");
  bool instruments = false;
  for (const SignalInfo& signal : kSignalTable)
    instruments = instruments || groups.contains(std::string(signal.name));
  if (instruments) {
    out << YAML::Key << "instruments" << YAML::Value << YAML::BeginMap;
    for (const SignalInfo& signal : kSignalTable)
      if (const std::string name(signal.name); groups.contains(name)) emit(name, name);
    out << YAML::EndMap;
  }
  const ControllerSettings& c = rig.controller;
  out << YAML::Key << "controller" << YAML::Value << YAML::BeginMap;
  const auto setting = [&](const char* key, double value, std::string_view unit) {
    out << YAML::Key << key << YAML::Value << with_unit(value, unit);
  };
  setting("period", c.period, "s");
  setting("track_period", c.track_period, "s");
  setting("k_ff", c.k_ff, "1");
  setting("k_p", c.k_p, "1/s");
  setting("k_i", c.k_i, "1/s^2");
  setting("gain", c.gain, "V s/m");
  setting("limit", c.limit, "V");
  setting("counts_per_revolution", c.counts_per_revolution, "1");
  out << YAML::EndMap << YAML::EndMap;
  return with_comment(comment, out.c_str());
}

}  // namespace axisfit
