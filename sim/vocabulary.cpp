#include "sim/vocabulary.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <mutex>
#include <set>
#include <string>
#include <utility>

namespace axisfit {
namespace {

/// A unit on both joints, and how far the range of what has it differs: the smallest servo turns
/// 1e-9 kg m^2, and a joint may turn many times.
struct UnitPair {
  std::string_view prismatic, revolute;
  double lower = 1.0, upper = 1.0;  ///< factors
};
constexpr auto kUnits = std::to_array<UnitPair>({
    {"m", "rad", 1.0, 1e3},
    {"m/s", "rad/s", 1.0, 1e3},
    {"m/s^2", "rad/s^2", 1.0, 1e3},
    {"kg", "kg m^2", 1e-6, 1.0},
    {"N", "N m"},
    {"N/V", "N m/V", 1e-3, 1.0},
    {"N/A", "N m/A", 1e-3, 1.0},
    {"N/m", "N m/rad", 1e-3, 1.0},
    {"N/m^2", "N m/rad^2"},
    {"N s/m", "N m s/rad"},
    {"N s/m^2", "N m s/rad^2"},
    {"N s^2/m^2", "N m s^2/rad^2"},
    {"N s^3/m^3", "N m s^3/rad^3"},
    {"N/m^3", "N m/rad^3"},
    {"m/N", "rad/(N m)", 1.0, 1e3},
    {"1/N", "1/(N m)", 1.0, 1e3},
    {"1/N^2", "1/(N m)^2", 1.0, 1e6},
    {"1/m", "1/rad"},
    {"V s/m", "V s/rad", 1e-3, 1.0},
    {"A s/m", "A s/rad", 1e-3, 1.0},
    {"s/m", "s/rad", 1e-3, 1.0},
    {"V s^2/m", "V s^2/rad"},
    {"A s^2/m", "A s^2/rad"},
    {"s^2/m", "s^2/rad"},
});

/// A unit with that of the command in it, by what the command is.
struct UnitOfCommand {
  std::string_view written;
  std::array<std::string_view, std::size(kCommands)> of;
};
constexpr auto kOfCommand = std::to_array<UnitOfCommand>({
    {kCommandUnit, {"V", "A", "1"}},
    {"N/U", {"N/V", "N/A", "N"}},
    {"U s/m", {"V s/m", "A s/m", "s/m"}},
    {"U s^2/m", {"V s^2/m", "A s^2/m", "s^2/m"}},
});

using Exchange = std::pair<std::string_view, std::string_view>;

/// Where word by word is not how it is said.
constexpr auto kPhrases = std::to_array<Exchange>({
    {"force_droop", "drive_torque_droop"},
    {"stroke_spring", "joint_spring"},
    {"stiffness along the stroke", "stiffness of a spring at the joint"},
    {"pinion radius", "angle of the joint per angle of the motor"},
    {"motor torque as a force at the rack", "motor torque at the joint"},
    {"rack and pinion with backlash, stiffness and damping",
     "gear with backlash, stiffness and damping"},
});
constexpr auto kWords = std::to_array<Exchange>({
    {"force", "torque"},
    {"forces", "torques"},
    {"Force", "Torque"},
    {"mass", "inertia"},
    {"masses", "inertias"},
    {"Mass", "Inertia"},
    {"arm", "joint"},
    {"Arm", "Joint"},
    {"newton", "newton metre"},
    {"metre", "radian"},
    {"metres", "radians"},
    {"newtons", "newton metres"},
    {"stroke", "travel"},
});
constexpr auto kSymbols = std::to_array<Exchange>({
    {"M", "J"},
    {"dM", "dJ"},
    {"m_e", "J_e"},
    {"dF", "dT"},
    {"dF_c", "dT_c"},
});

template <class Table>
const Exchange* find(const Table& table, std::string_view text) {
  const auto found = std::ranges::find(table, text, &Exchange::first);
  return found == std::end(table) ? nullptr : &*found;
}

const UnitPair* find_unit(std::string_view unit) {
  const auto* found = std::ranges::find(kUnits, unit, &UnitPair::prismatic);
  return found == kUnits.end() ? nullptr : found;
}

/// What was put in here first, for the life of the program.
template <class Value>
const Value& kept_for_good(Value value) {
  static std::mutex mutex;
  static std::set<Value> values;
  const std::lock_guard lock(mutex);
  return *values.insert(std::move(value)).first;
}

/// The same text for the life of the program.
std::string_view kept(std::string text) { return kept_for_good(std::move(text)); }

/// "N s/m" per "degC" is "N s/m/K": of a difference of temperatures the zero does not count.
std::string unit_per(std::string_view unit, std::string_view channel) {
  if (channel == "1") return std::string(unit);
  if (channel == "degC") channel = "K";
  const bool is_plain = channel.find_first_of(" /*.^") == std::string_view::npos;
  return std::string(unit) +
         (is_plain ? "/" + std::string(channel) : "/(" + std::string(channel) + ")");
}

/// A quantity that is related to a channel, in its words: "mass per channel" is "mass per unit of
/// neighbour".
Quantity of_channel(Quantity quantity, const Channel& channel) {
  quantity.symbol = channel.name;
  quantity.unit = kept(unit_per(quantity.unit, channel.unit));
  const std::string_view what = quantity.meaning.substr(0, quantity.meaning.rfind("channel"));
  quantity.meaning = kept(std::string(what) + "unit of " + channel.name);
  return quantity;
}

Quantity on_joint(Vocabulary vocabulary, const Quantity& quantity);

}  // namespace

Channels kept(const ChannelList& channels) {
  return channels.empty() ? nullptr : &kept_for_good(channels);
}

std::string_view unit_on(Vocabulary vocabulary, std::string_view unit) {
  if (const auto* by_command = std::ranges::find(kOfCommand, unit, &UnitOfCommand::written);
      by_command != kOfCommand.end())
    unit = by_command->of[static_cast<std::size_t>(vocabulary.command)];
  const UnitPair* pair = vocabulary.joint == Joint::revolute ? find_unit(unit) : nullptr;
  return pair == nullptr ? unit : pair->revolute;
}

std::string_view words_on(Vocabulary vocabulary, std::string_view text) {
  if (vocabulary.joint == Joint::prismatic) return text;
  if (const Exchange* whole = find(kPhrases, text)) return whole->second;
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  std::string said;
  for (auto at = text.begin(); at != text.end();) {
    const auto end = is_letter(*at) ? std::find_if_not(at, text.end(), is_letter) : at + 1;
    const std::string_view word(at, end);
    const Exchange* other = find(kWords, word);
    said += other == nullptr ? word : other->second;
    at = end;
  }
  return kept(std::move(said));
}

Quantity quantity_on(Vocabulary vocabulary, const Quantity& quantity) {
  Quantity called = on_joint(vocabulary, quantity);
  const auto place = quantity.channel;
  return place && vocabulary.channels != nullptr && *place < vocabulary.channels->size()
             ? of_channel(called, (*vocabulary.channels)[*place])
             : called;
}

namespace {

Quantity on_joint(Vocabulary vocabulary, const Quantity& quantity) {
  Quantity called = quantity;
  called.unit = unit_on({Joint::prismatic, vocabulary.command}, quantity.unit);
  if (quantity.symbol == "K_f" && vocabulary.command == Command::current)
    called.meaning = "force per ampere of the motor";
  if (quantity.symbol == "K_f" && vocabulary.command == Command::share_of_rated)
    called.meaning = "rated force";
  if (quantity.symbol == "r_g" && vocabulary.gearing == Gearing::turns) {
    called.lower = 1e-5;
    called.symbol = "lead";
    called.meaning = "travel per revolution of the motor";
    if (vocabulary.joint == Joint::prismatic) return called;
    called.symbol = "gear_ratio";
    called.unit = "1";
    called.meaning = "turns of the motor per turn of the joint";
    called.lower = 1e-3;
    called.upper = 1e5;
    return called;
  }
  if (vocabulary.joint == Joint::prismatic) return called;
  called.meaning = words_on(vocabulary, called.meaning);
  if (const Exchange* symbol = find(kSymbols, quantity.symbol))
    called.symbol = symbol->second;
  else if (quantity.symbol.starts_with("F_"))
    called.symbol = kept("T_" + std::string(quantity.symbol.substr(2)));
  if (quantity.symbol == "r_g") {
    called.unit = "1";  // of angles
    called.default_value = 1.0;
  } else if (const UnitPair* unit = find_unit(called.unit)) {
    called.unit = unit->revolute;
    called.lower *= called.lower > 0.0 ? unit->lower : unit->upper;
    called.upper *= unit->upper;
  }
  return called;
}

}  // namespace

}  // namespace axisfit
