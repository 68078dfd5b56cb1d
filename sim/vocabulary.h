// How the quantities of a machine are called. The equations are the same for a load that slides and
// for one that turns, and for a command in volts and in amperes; names, units and ranges follow
// here from those of a load that slides and of a command in volts, in which the sources are
// written.
#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <string_view>

#include "sim/quantity.h"

namespace axisfit {

enum class Joint {
  prismatic,  ///< it slides: m, N, kg
  revolute,   ///< it turns: rad, N m, kg m^2
};
inline constexpr Joint kJoints[]{Joint::prismatic, Joint::revolute};

/// What the command of a drive is.
enum class Command {
  voltage,         ///< V
  current,         ///< A
  share_of_rated,  ///< 1, of the rated force: as drives give it in per cent or per mille
};
inline constexpr Command kCommands[]{Command::voltage, Command::current, Command::share_of_rated};

struct Vocabulary {
  Joint joint = Joint::prismatic;
  Command command = Command::voltage;

  constexpr Vocabulary() = default;
  // Implicit: a joint alone is that of a command in volts.
  // NOLINTNEXTLINE(google-explicit-constructor)
  constexpr Vocabulary(Joint of_joint, Command of_command = Command::voltage)
      : joint(of_joint), command(of_command) {}
  bool operator==(const Vocabulary&) const = default;
};

inline constexpr std::size_t kVocabularies = std::size(kJoints) * std::size(kCommands);

/// All of them, that of the sources first.
constexpr std::array<Vocabulary, kVocabularies> all_vocabularies() {
  std::array<Vocabulary, kVocabularies> all;
  auto next = all.begin();
  for (const Joint joint : kJoints)
    for (const Command command : kCommands) *next++ = {joint, command};
  return all;
}

/// Its place among them.
constexpr std::size_t index_of(Vocabulary vocabulary) {
  return static_cast<std::size_t>(vocabulary.joint) * std::size(kCommands) +
         static_cast<std::size_t>(vocabulary.command);
}

/// make(vocabulary) of each, in their order.
template <class Make>
auto for_all_vocabularies(Make&& make) {
  std::array<decltype(make(Vocabulary())), kVocabularies> made;
  for (const Vocabulary vocabulary : all_vocabularies())
    made[index_of(vocabulary)] = make(vocabulary);
  return made;
}

/// A unit of a load that slides, "N s/m", as it is on the machine's joint: "N m s/rad". Those of
/// motors, instruments and times stay.
std::string_view unit_on(Vocabulary vocabulary, std::string_view unit);

/// A name or sentence about a load that slides as it is said of the machine: "constant_force" is
/// "constant_torque", "arm mass" is "joint inertia". Whole words alone are exchanged.
std::string_view words_on(Vocabulary vocabulary, std::string_view text);

/// A quantity with its symbol ("F_c": "T_c"), unit, meaning and range on the machine.
Quantity quantity_on(Vocabulary vocabulary, const Quantity& quantity);

}  // namespace axisfit
