#include "io/config/axis_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/suggest.h"
#include "base/units.h"

namespace axisfit {
namespace {

/// Keys for the quantities of a group.
Section quantity_keys(std::string_view group) {
  Section keys;
  for (const QuantityEntry& entry : quantity_list())
    if (entry.group == group) keys.push_back(Key::of(entry.quantity));
  return keys;
}

Section effect_keys() {
  Section keys;
  const Effects<double> effects{};
  visit_effects(effects, [&](std::size_t, const auto& effect) {
    Section parameters = quantity_keys(effect.name);
    // An effect that is not used is refused as a whole.
    const std::string used = parameters.front().used_by;
    for (Key& parameter : parameters) parameter.used_by.clear();
    keys.push_back(Key::optional(std::string(effect.name), Map{std::move(parameters)},
                                 DefaultText{"effect absent"}, std::string(effect.meaning)));
    keys.back().used_by = used;
  });
  return keys;
}

Section instrument_keys() {
  Section keys;
  for (const SignalInfo& signal : kSignalTable) {
    Section settings = quantity_keys(signal.name);
    settings.push_back(Key::optional(
        "noise", NumberWithUnit{std::string(signal.unit), 0.0, 1e6},
        Rig().noise[index_of(signal.signal)],
        "standard deviation of the white Gaussian noise; used by simulate-axis only"));
    keys.push_back(Key::optional(std::string(signal.name), Map{std::move(settings)},
                                 DefaultText{"ideal"}, std::string(signal.meaning)));
  }
  return keys;
}

Section controller_keys() {
  Section keys;
  ControllerSettings settings;
  visit_settings(settings,
                 [&](const Quantity& quantity, double) { keys.push_back(Key::of(quantity)); });
  return keys;
}

std::string describe(const Structure& structure) {
  return fmt::format("drive {} and transmission {}",
                     drive_names()[static_cast<std::size_t>(structure.drive)],
                     transmission_names()[static_cast<std::size_t>(structure.transmission)]);
}

void read_parameters(const ConfigNode& node, Model<double>& model) {
  ConfigMap map(node, keys_below(axis_keys(), "parameters"));
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list()) {
    if (!entry.group.empty()) continue;
    const Quantity& quantity = entry.quantity;
    double& value = *member[entry.index];
    if (!is_used(entry, model.structure)) {
      if (const auto given = map.optional(quantity.symbol))
        given->error(fmt::format("{} is not used by an axis with {}: remove it", quantity.symbol,
                                 describe(model.structure)));
      continue;
    }
    value = std::isnan(quantity.default_value) ? quantity.upper : quantity.default_value;
    map.read(quantity.symbol, value);
  }
  map.finish();
}

void read_initial(const ConfigNode& node, Model<double>& model) {
  ConfigMap map(node, keys_below(axis_keys(), "initial"));
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list())
    if (entry.group == "initial" && is_used(entry, model.structure))
      map.read(entry.quantity.symbol, *member[entry.index]);
  map.finish();
}

void read_instruments(const ConfigNode& node, Rig& rig) {
  const Section& keys = keys_below(axis_keys(), "instruments");
  ConfigMap map(node, keys);
  const std::vector<double*> member = members(rig.model);
  for (const SignalInfo& signal : kSignalTable) {
    const auto given = map.optional(signal.name);
    if (!given) continue;
    ConfigMap instrument(*given, keys_below(keys, signal.name));
    for (const QuantityEntry& entry : quantity_list())
      if (entry.group == signal.name) instrument.read(entry.quantity.symbol, *member[entry.index]);
    instrument.read("noise", rig.noise[index_of(signal.signal)]);
    instrument.finish();
  }
  map.finish();
}

void read_controller(const ConfigNode& node, ControllerSettings& settings) {
  ConfigMap map(node, keys_below(axis_keys(), "controller"));
  visit_settings(settings,
                 [&](const Quantity& setting, double& value) { map.read(setting.symbol, value); });
  map.finish();
}

void read_guessed(const ConfigNode& node, Rig& rig) {
  const auto entries = node.as_sequence();
  if (!entries) return;
  for (const ConfigNode& entry : *entries) {
    const QuantityEntry* quantity =
        entry.as_string() ? quantity_named(entry, rig.model.structure) : nullptr;
    if (quantity == nullptr) continue;
    if (std::ranges::count(rig.guessed, quantity->index) > 0)
      entry.error(fmt::format("{} is listed twice", quantity->name));
    rig.guessed.push_back(quantity->index);
  }
}

}  // namespace

const Section& axis_keys() {
  static const Section keys{
      Key::optional("name", Text{}, DefaultText{"none"}, "shown in reports"),
      Key::required("drive",
                    Choice{{{"velocity_loop", "the paper's controller and current loop"},
                            {"current_source", "an ideal power stage"},
                            {"force_source", "the command is a force"}}},
                    "what turns the command into a force"),
      Key::required("transmission",
                    Choice{{{"backlash", "rack and pinion with backlash, stiffness and damping"},
                            {"rigid", "motor and arm move as one mass"}}},
                    "what transmits the force to the arm"),
      Key::optional("guessed", List{{Text{}}}, DefaultText{"none"},
                    "quantities whose values here are guesses, such as `[K_f]`; the report names "
                    "the estimates that rest on them"),
      Key::required("parameters", Map{quantity_keys("")}, "parameters of the paper's model"),
      Key::optional(
          "effects", Map{effect_keys()}, DefaultText{"none"},
          "effects beyond the paper's model, by name; an effect is active if it is listed"),
      Key::optional("initial", Map{quantity_keys("initial")}, DefaultText{"all 0"},
                    "initial state"),
      Key::optional("instruments", Map{instrument_keys()}, DefaultText{"ideal"},
                    "gain, bias, lag, delay, drift and noise of each signal"),
      Key::optional("controller", Map{controller_keys()}, DefaultText{"those of its keys"},
                    "the slave control unit: limits, moves and the encoder; a fit uses it only to "
                    "compute the command from a `position_reference`")};
  return keys;
}

const std::vector<std::string>& drive_names() {
  static const auto names = std::get<Choice>(find_key(axis_keys(), "drive").form).names();
  return names;
}

const std::vector<std::string>& transmission_names() {
  static const auto names = std::get<Choice>(find_key(axis_keys(), "transmission").form).names();
  return names;
}

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
            ? fmt::format("{} is not used by this axis, because of its drive or transmission", name)
            : fmt::format("{} belongs to an effect that is not active: add it to the axis or job, "
                          "as in 'effects: {{{}: "
                          "{{{}: ...}}}}'",
                          name, entry->group, entry->quantity.symbol));
    return nullptr;
  }
  std::vector<std::string> names;
  for (const QuantityEntry& e : quantity_list())
    if (is_used(e, structure)) names.push_back(e.name);
  const std::string suggestion = closest_match(name, names);
  key.error(
      fmt::format("unknown quantity '{}'; {}", name,
                  suggestion.empty()
                      ? "valid names are parameters of the axis, EFFECT.PARAMETER, "
                        "SIGNAL.gain, .bias, .lag, .delay and .drift, and initial.y0 ... initial.y6"
                      : fmt::format("did you mean '{}'?", suggestion)));
  return nullptr;
}

void read_effects(const ConfigNode& node, Model<double>& model) {
  const Section& keys = keys_below(axis_keys(), "effects");
  ConfigMap map(node, keys);
  visit_effects(model.effects, [&](std::size_t index, auto& effect) {
    const auto given = map.optional(effect.name);
    if (!given) return;
    model.structure.effects.set(index);
    ConfigMap parameters(*given, keys_below(keys, effect.name));
    bool used = false;
    effect.visit(effect, [&](const Quantity& quantity, double& value) {
      used = used || is_used(*find_quantity(full_name(effect.name, quantity)), model.structure);
      value = std::isnan(quantity.default_value) ? 0.0 : quantity.default_value;
      parameters.read(quantity.symbol, value);
    });
    parameters.finish();
    if (!used)
      given->error(fmt::format("{} is not used by an axis with {}: remove it", effect.name,
                               describe(model.structure)));
  });
  map.finish();
}

std::optional<Rig> read_axis_file(const std::string& path, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.count();
  const auto root = ConfigNode::load(path, diagnostics);
  auto rig = root ? read_axis(*root, diagnostics) : std::nullopt;
  return diagnostics.count() > before ? std::nullopt : std::move(rig);
}

std::optional<Rig> read_axis(const ConfigNode& root, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.count();
  Rig rig;
  ConfigMap map(root, axis_keys());
  map.read("name", rig.name);
  std::optional<Drive> drive;
  std::optional<Transmission> transmission;
  map.read("drive", drive);
  map.read("transmission", transmission);
  rig.model.structure.drive = drive.value_or(Drive());
  rig.model.structure.transmission = transmission.value_or(Transmission());
  if (const auto effects = map.optional("effects")) read_effects(*effects, rig.model);
  const auto parameters = map.required("parameters");
  const auto initial = map.optional("initial");
  const auto guessed = map.optional("guessed");
  if (drive && transmission) {  // what quantities an axis has depends on them
    if (parameters) read_parameters(*parameters, rig.model);
    if (initial) read_initial(*initial, rig.model);
    if (guessed) read_guessed(*guessed, rig);
  }
  normalize(rig.model);
  if (const auto instruments = map.optional("instruments")) read_instruments(*instruments, rig);
  // Without a pinion there is no telling how far a count is, unless it is said.
  if (!capabilities(rig.model.structure).has_motor) rig.controller.counts_per_revolution = 0.0;
  if (const auto controller = map.optional("controller"))
    read_controller(*controller, rig.controller);
  map.finish();
  if (diagnostics.count() > before) return std::nullopt;
  if (const std::string reason = model_error(rig.model); !reason.empty()) {
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
  out << YAML::Key << "drive" << YAML::Value
      << drive_names()[static_cast<std::size_t>(structure.drive)];
  out << YAML::Key << "transmission" << YAML::Value
      << transmission_names()[static_cast<std::size_t>(structure.transmission)];
  if (!rig.guessed.empty()) {
    out << YAML::Key << "guessed" << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const std::size_t g : rig.guessed) out << quantity_list()[g].name;
    out << YAML::EndSeq;
  }

  // The quantities in use by group, in the order of the list; those at their standard value are
  // left out where that is the custom (instruments, initial state).
  std::map<std::string, std::vector<std::pair<std::string, std::string>>> groups;
  Model<double> model = rig.model;
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list()) {
    const double value = *member[entry.index];
    const bool custom = entry.group == "initial" || signal_by_name(entry.group).has_value();
    if (!is_used(entry, structure) || (custom && value == entry.quantity.default_value)) continue;
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
  out << YAML::Key << "controller" << YAML::Value << YAML::BeginMap;
  visit_settings(rig.controller, [&](const Quantity& setting, double value) {
    out << YAML::Key << std::string(setting.symbol) << YAML::Value
        << with_unit(value, setting.unit);
  });
  out << YAML::EndMap << YAML::EndMap;
  return with_comment(comment, out.c_str());
}

}  // namespace axisfit
