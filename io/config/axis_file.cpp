#include "io/config/axis_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>

#include "base/suggest.h"
#include "base/units.h"
#include "io/config/axis_uncertainty.h"
#include "io/config/channels.h"

namespace axisfit {
namespace {

/// The key of a quantity, and those of a group of them.
Key key_of(Vocabulary vocabulary, const Quantity& quantity, std::string name) {
  Key key = Key::of(quantity, std::move(name));
  key.used_by = words_on(vocabulary, key.used_by);
  return key;
}
/// Whether it has a name: one that is related to a channel, if there is the channel.
bool is_named(Vocabulary vocabulary, const Quantity& quantity) {
  return !quantity.channel ||
         (vocabulary.channels != nullptr && *quantity.channel < vocabulary.channels->size());
}

Section quantity_keys(Vocabulary vocabulary, std::string_view group) {
  Section keys;
  for (const QuantityEntry& entry : quantity_list(vocabulary))
    if (entry.group == group && is_named(vocabulary, entry.quantity))
      keys.push_back(key_of(vocabulary, entry.quantity, std::string(entry.quantity.symbol)));
  return keys;
}

/// Whether the parameters tell a lead or a gear ratio instead of a radius.
Gearing gearing_of(const ConfigNode& parameters, Vocabulary vocabulary) {
  if (!parameters.is_map()) return Gearing::radius;
  vocabulary.gearing = Gearing::turns;
  const QuantityEntry& in_turns = quantity_list(vocabulary)[quantity_index("r_g")];
  return ConfigMap(parameters).optional(in_turns.quantity.symbol) ? Gearing::turns
                                                                  : Gearing::radius;
}

/// Whether its quantities are related to channels.
bool acts_by_channels(const EffectInfo& effect) { return effect.name.starts_with("channel_"); }

Section effect_keys(Vocabulary vocabulary) {
  Section keys;
  for (const EffectInfo& effect : kEffectTable) {
    const std::string name(words_on(vocabulary, effect.name));
    Map parameters{quantity_keys(vocabulary, name)};
    // An effect that is not used is refused as a whole.
    std::string used;
    for (Key& parameter : parameters.keys) used = std::exchange(parameter.used_by, {});
    if (acts_by_channels(effect) && vocabulary.channels == nullptr)
      parameters.named = {{std::string(kChannelName), amount_per_channel()}};
    keys.push_back(Key::optional(name, std::move(parameters), DefaultText{"effect absent"},
                                 std::string(words_on(vocabulary, effect.meaning))));
    keys.back().used_by = used;
  }
  return keys;
}

Section instrument_keys(Vocabulary vocabulary) {
  Section keys;
  for (const SignalInfo& of_sliding : kSignalTable) {
    const SignalInfo signal = info(of_sliding.signal, vocabulary);
    Section settings = quantity_keys(vocabulary, signal.name);
    settings.push_back(Key::optional(
        "noise", NumberWithUnit{std::string(signal.unit), 0.0, 1e6},
        Rig().noise[index_of(signal.signal)],
        "standard deviation of the white Gaussian noise; used by simulate-axis only"));
    keys.push_back(Key::optional(std::string(signal.name), Map{std::move(settings)},
                                 DefaultText{"ideal"}, std::string(signal.meaning)));
  }
  return keys;
}

Section controller_keys(Vocabulary vocabulary) {
  Section keys;
  const Controller<double> controller;
  visit_settings(controller, [&](const Quantity& quantity, double) {
    keys.push_back(Key::of(quantity_on(vocabulary, quantity)));
  });
  return keys;
}

std::string describe(const Structure& structure) {
  return fmt::format("drive {} and transmission {}", drive_name(structure.drive, structure.joint),
                     transmission_name(structure.transmission));
}

void read_parameters(const ConfigNode& node, Model<double>& model) {
  ConfigMap map(node, keys_below(axis_keys(vocabulary_of(model.structure)), "parameters"));
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list(vocabulary_of(model.structure))) {
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
  ConfigMap map(node, keys_below(axis_keys(vocabulary_of(model.structure)), "initial"));
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list(vocabulary_of(model.structure)))
    if (entry.group == "initial" && is_used(entry, model.structure))
      map.read(entry.quantity.symbol, *member[entry.index]);
  map.finish();
}

void read_instruments(const ConfigNode& node, Rig& rig) {
  const Vocabulary vocabulary = vocabulary_of(rig.model.structure);
  const Section& keys = keys_below(axis_keys(vocabulary), "instruments");
  ConfigMap map(node, keys);
  const std::vector<double*> member = members(rig.model);
  for (const SignalInfo& signal : kSignalTable) {
    const std::string_view name = info(signal.signal, vocabulary).name;
    const auto given = map.optional(name);
    if (!given) continue;
    ConfigMap instrument(*given, keys_below(keys, name));
    for (const QuantityEntry& entry : quantity_list(vocabulary))
      if (entry.signal == signal.signal)
        instrument.read(entry.quantity.symbol, *member[entry.index]);
    instrument.read("noise", rig.noise[index_of(signal.signal)]);
    instrument.finish();
  }
  map.finish();
}

void read_controller(const ConfigNode& node, Vocabulary vocabulary, Controller<double>& settings) {
  ConfigMap map(node, keys_below(axis_keys(vocabulary), "controller"));
  visit_settings(settings,
                 [&](const Quantity& setting, double& value) { map.read(setting.symbol, value); });
  const double samples = settings.timing.velocity_samples,
               frequency = settings.gains.notch_frequency,
               nyquist = 0.5 / settings.timing.command_period();
  if (samples != std::round(samples))
    node.error(fmt::format("velocity_samples must be a whole number, not {:.6g}", samples));
  if (settings.gains.notch_depth != 1.0 && !(frequency < nyquist))
    node.error(
        fmt::format("notch_frequency must be below {:.6g} Hz, half the sampling frequency of "
                    "the loop that filters",
                    nyquist));
  map.finish();
}

void read_guessed(const ConfigNode& node, Rig& rig) {
  const auto entries = node.as_sequence();
  if (!entries) return;
  Structure structure = rig.model.structure;
  structure.closed_loop = true;  // jobs may simulate the loop
  for (const ConfigNode& entry : *entries) {
    const QuantityEntry* quantity = entry.as_string() ? quantity_named(entry, structure) : nullptr;
    if (quantity == nullptr) continue;
    if (std::ranges::count(rig.guessed, quantity->index) > 0)
      entry.error(fmt::format("{} is listed twice", quantity->name));
    rig.guessed.push_back(quantity->index);
  }
}

}  // namespace

namespace {

Section make_axis_keys(Vocabulary vocabulary) {
  const auto say = [&](const char* text) { return std::string(words_on(vocabulary, text)); };
  return {
      Key::optional("name", Text{}, DefaultText{"none"}, "shown in reports"),
      Key::optional("joint",
                    Choice{{{"prismatic", "the load slides: m, N and kg"},
                            {"revolute", "it turns: rad, N m and kg m^2"}}},
                    Joint::prismatic,
                    "what the load does; it decides on the names and units of the other keys"),
      Key::required(
          "drive",
          Choice{{{"velocity_loop", "the paper's controller and current loop"},
                  {"current_source", "an ideal power stage"},
                  {say("force_source"), say("the command, in V, is a force")},
                  {"motor_current", "it is the motor's current, in A"},
                  {say("rated_force"), say("it is a share of the rated force, such as 120 %")},
                  {"motor_voltage", "it is the voltage at a motor with resistance and back EMF"}}},
          say("what turns the command into a force")),
      Key::required(
          "transmission",
          Choice{{{"backlash", say("rack and pinion with backlash, stiffness and damping")},
                  {"rigid", say("motor and arm move as one mass")}}},
          say("what transmits the force to the arm")),
      axis_channels_key(),
      Key::optional("guessed", List{{Text{}}}, DefaultText{"none"},
                    "quantities whose values here are guesses, such as `[K_f]`; the report names "
                    "the estimates that rest on them"),
      Key::required("parameters", Map{quantity_keys(vocabulary, "")},
                    "parameters of the paper's model"),
      Key::optional(
          "effects", Map{effect_keys(vocabulary)}, DefaultText{"none"},
          "effects beyond the paper's model, by name; an effect is active if it is listed"),
      Key::optional("initial", Map{quantity_keys(vocabulary, "initial")}, DefaultText{"all 0"},
                    "initial state"),
      Key::optional("instruments", Map{instrument_keys(vocabulary)}, DefaultText{"ideal"},
                    "gain, bias, lag, delay, drift and noise of each signal"),
      Key::optional("controller", Map{controller_keys(vocabulary)},
                    DefaultText{"those of its keys"},
                    "the position controller: limits, moves and the encoder; a fit uses it for "
                    "recordings with a `position_reference`"),
      axis_uncertainty_key(vocabulary)};
}

std::vector<std::string> choices_of(Vocabulary vocabulary, std::string_view key) {
  return std::get<Choice>(find_key(axis_keys(vocabulary), key).form).names();
}

}  // namespace

const Section& axis_keys(Vocabulary vocabulary) {
  // They are many: only those that are asked for.
  static PerVocabulary<Section> made;
  return made.of(vocabulary, make_axis_keys);
}

const std::string& joint_name(Joint joint) {
  static const auto names = choices_of({}, "joint");
  return names[static_cast<std::size_t>(joint)];
}

const std::string& drive_name(Drive drive, Joint joint) {
  static const std::array names{choices_of(Joint::prismatic, "drive"),
                                choices_of(Joint::revolute, "drive")};
  return names[static_cast<std::size_t>(joint)][static_cast<std::size_t>(drive)];
}

const std::string& transmission_name(Transmission transmission) {
  static const auto names = choices_of({}, "transmission");
  return names[static_cast<std::size_t>(transmission)];
}

Section quantity_keys() {
  Section keys;
  for (const Vocabulary vocabulary : all_vocabularies())
    for (const QuantityEntry& entry : quantity_list(vocabulary)) {
      if (!is_named(vocabulary, entry.quantity)) continue;
      Key key = key_of(vocabulary, entry.quantity, entry.name);
      const auto known = std::ranges::find(keys, entry.name, &Key::name);
      if (known == keys.end()) {
        keys.push_back(std::move(key));
      } else if (auto& amount = std::get<NumberWithUnit>(known->form);
                 amount.unit != entry.quantity.unit) {
        if (const std::string before = value_text(known->form), here = value_text(key.form);
            before.find(here) == std::string::npos)
          amount.description = fmt::format("{} or {}", before, here);
      }
    }
  return keys;
}

Section effect_keys() {
  Section keys = effect_keys(Joint::prismatic);
  for (Key& turning : effect_keys(Joint::revolute)) {
    const auto sliding = std::ranges::find(keys, turning.name, &Key::name);
    if (sliding == keys.end())
      keys.push_back(std::move(turning));
    else
      sliding->form = AnyOf{{std::move(turning.form), std::move(sliding->form)}};
  }
  return keys;
}

std::optional<double> read_value(const ConfigNode& node, const Quantity& quantity) {
  return node.as_quantity(quantity.unit, quantity.lower, quantity.upper);
}

const QuantityEntry* quantity_named(const ConfigNode& key, const Structure& structure) {
  const std::string name = key.text();
  const QuantityEntry* entry = find_quantity(name, vocabulary_of(structure));
  if (entry != nullptr && is_used(*entry, structure)) return entry;
  if (entry != nullptr) {
    const bool parameter = entry->group.empty() || entry->group == "initial";
    key.error(
        parameter
            ? fmt::format("{} is not used by this axis, because of its drive or transmission", name)
        : entry->group == "controller"
            ? fmt::format("{} needs a recording with a position_reference whose loop is simulated",
                          name)
            : fmt::format("{} belongs to an effect that is not active: add it to the axis or job, "
                          "as in 'effects: {{{}: "
                          "{{{}: ...}}}}'",
                          name, entry->group, entry->quantity.symbol));
    return nullptr;
  }
  std::vector<std::string> names;
  for (const QuantityEntry& e : quantity_list(vocabulary_of(structure)))
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
  const Vocabulary vocabulary = vocabulary_of(model.structure);
  const Section& keys = keys_below(axis_keys(vocabulary), "effects");
  ConfigMap map(node, keys);
  visit_effects(model.effects, [&](std::size_t index, auto& effect) {
    const std::string_view name = words_on(vocabulary, effect.name);
    const auto given = map.optional(name);
    if (!given) return;
    model.structure.effects.set(index);
    ConfigMap parameters(*given, keys_below(keys, name));
    bool used = false;
    if (acts_by_channels(kEffectTable[index]) && vocabulary.channels == nullptr) {
      given->error(
          fmt::format("{} needs a channel: declare it, as in 'channels: {{temperature: "
                      "{{unit: degC}}}}', or name its column in every recording of the job",
                      name));
      return;
    }
    effect.visit(effect, [&](const Quantity& quantity, double& value) {
      if (!is_named(vocabulary, quantity)) return;
      used = used || is_used(quantity_list()[quantity_index(full_name(effect.name, quantity))],
                             model.structure);
      value = std::isnan(quantity.default_value) ? 0.0 : quantity.default_value;
      parameters.read(quantity_on(vocabulary, quantity).symbol, value);
    });
    parameters.finish();
    if (!used)
      given->error(fmt::format("{} is not used by an axis with {}: remove it", name,
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
  ConfigMap map(root, axis_keys(kSourceVocabulary));
  map.read("joint", rig.model.structure.joint);
  map.describe(axis_keys(rig.model.structure.joint));
  map.read("name", rig.name);
  if (const auto channels = map.optional("channels")) read_channels(*channels, rig.model.structure);
  std::optional<Drive> drive;
  std::optional<Transmission> transmission;
  map.read("drive", drive);
  map.read("transmission", transmission);
  rig.model.structure.drive = drive.value_or(Drive());
  const auto parameters = map.required("parameters");
  if (parameters)
    rig.model.structure.gearing = gearing_of(*parameters, vocabulary_of(rig.model.structure));
  map.describe(axis_keys(vocabulary_of(rig.model.structure)));
  rig.model.structure.transmission = transmission.value_or(Transmission());
  if (const auto effects = map.optional("effects")) read_effects(*effects, rig.model);
  const auto initial = map.optional("initial");
  const auto guessed = map.optional("guessed");
  const auto uncertainty = map.optional("uncertainty");
  if (drive && transmission) {  // what quantities an axis has depends on them
    if (parameters) read_parameters(*parameters, rig.model);
    if (initial) read_initial(*initial, rig.model);
    if (guessed) read_guessed(*guessed, rig);
    if (uncertainty) rig.uncertainty = read_axis_uncertainty(*uncertainty, rig.model.structure);
  }
  normalize(rig.model);
  if (const auto instruments = map.optional("instruments")) read_instruments(*instruments, rig);
  // Without a pinion there is no telling how far a count is, unless it is said.
  if (!capabilities(rig.model.structure).has_motor)
    rig.model.controller.timing.counts_per_revolution = 0.0;
  if (const auto controller = map.optional("controller"))
    read_controller(*controller, vocabulary_of(rig.model.structure), rig.model.controller);
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
  const Vocabulary vocabulary = vocabulary_of(structure);
  if (structure.joint != Joint::prismatic)
    out << YAML::Key << "joint" << YAML::Value << joint_name(structure.joint);
  out << YAML::Key << "drive" << YAML::Value << drive_name(structure.drive, structure.joint);
  out << YAML::Key << "transmission" << YAML::Value << transmission_name(structure.transmission);
  if (structure.channels != nullptr) {
    out << YAML::Key << "channels" << YAML::Value << YAML::BeginMap;
    for (const Channel& channel : *structure.channels)
      out << YAML::Key << channel.name << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key
          << "unit" << YAML::Value << channel.unit << YAML::Key << "zero" << YAML::Value
          << with_unit(channel.zero, channel.unit) << YAML::EndMap;
    out << YAML::EndMap;
  }
  if (!rig.guessed.empty()) {
    out << YAML::Key << "guessed" << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const std::size_t g : rig.guessed) out << quantity_list(vocabulary)[g].name;
    out << YAML::EndSeq;
  }

  // The quantities in use by group, in the order of the list; those at their standard value are
  // left out where that is the custom (instruments, initial state, channels).
  std::map<std::string, std::vector<std::pair<std::string, std::string>>> groups;
  Model<double> model = rig.model;
  const std::vector<double*> member = members(model);
  for (const QuantityEntry& entry : quantity_list(vocabulary)) {
    const double value = *member[entry.index];
    const bool custom = entry.group == "initial" || entry.signal || entry.quantity.channel;
    if (!is_used(entry, structure) || (custom && value == entry.quantity.default_value)) continue;
    groups[entry.group].emplace_back(entry.quantity.symbol, with_unit(value, entry.quantity.unit));
  }
  std::vector<SignalInfo> signals;
  for (const SignalInfo& signal : kSignalTable) signals.push_back(info(signal.signal, vocabulary));
  for (const SignalInfo& signal : signals)
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
      const std::string name(words_on(vocabulary, effect.name));
      if (structure.effects[index]) emit(name, name);
    });
    out << YAML::EndMap;
  }
  if (groups.contains("initial")) emit("initial", "initial");
  bool instruments = false;
  for (const SignalInfo& signal : signals)
    instruments = instruments || groups.contains(std::string(signal.name));
  if (instruments) {
    out << YAML::Key << "instruments" << YAML::Value << YAML::BeginMap;
    for (const SignalInfo& signal : signals)
      if (const std::string name(signal.name); groups.contains(name)) emit(name, name);
    out << YAML::EndMap;
  }
  out << YAML::Key << "controller" << YAML::Value << YAML::BeginMap;
  visit_settings(rig.model.controller, [&](const Quantity& setting, double value) {
    // What few controllers have.
    if (value == setting.default_value && (value == 0.0 || setting.symbol == "speed_limit")) return;
    out << YAML::Key << std::string(setting.symbol) << YAML::Value
        << with_unit(value, unit_on(vocabulary, setting.unit));
  });
  out << YAML::EndMap;
  if (rig.uncertainty) write_axis_uncertainty(out, *rig.uncertainty, vocabulary);
  out << YAML::EndMap;
  return with_comment(comment, out.c_str());
}

}  // namespace axisfit
