// How the quantities of a machine are called. The equations are the same for a load that slides and
// for one that turns, and for a command in volts and in amperes; names, units and ranges follow
// here from those of a load that slides and of a command in volts, in which the sources are
// written.
#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include "sim/channel.h"
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

/// By what the motor and the load are geared to each other.
enum class Gearing {
  radius,  ///< r_g, metres (radians) of the load per radian of the motor
  turns,   ///< the lead of a screw, m per revolution; the ratio of a gearbox before a joint
};
inline constexpr Gearing kGearings[]{Gearing::radius, Gearing::turns};

/// A list of channels that stays: the same one for the same channels; null for none.
using Channels = const ChannelList*;
Channels kept(const ChannelList& channels);

struct Vocabulary {
  Joint joint = Joint::prismatic;
  Command command = Command::voltage;
  Channels channels = nullptr;  ///< by which the quantities that are related to them are called
  Gearing gearing = Gearing::radius;

  constexpr Vocabulary() = default;
  // Implicit: a joint alone is that of a command in volts.
  // NOLINTNEXTLINE(google-explicit-constructor)
  constexpr Vocabulary(Joint of_joint, Command of_command = Command::voltage,
                       Channels of_channels = nullptr, Gearing of_gearing = Gearing::radius)
      : joint(of_joint), command(of_command), channels(of_channels), gearing(of_gearing) {}
  bool operator==(const Vocabulary&) const = default;
};

/// How the sources call all of it.
inline constexpr Vocabulary kSourceVocabulary;

inline constexpr std::size_t kVocabularies =
    std::size(kGearings) * std::size(kJoints) * std::size(kCommands);

/// All without channels, that of the sources first.
constexpr std::array<Vocabulary, kVocabularies> all_vocabularies() {
  std::array<Vocabulary, kVocabularies> all;
  auto next = all.begin();
  for (const Gearing gearing : kGearings)
    for (const Joint joint : kJoints)
      for (const Command command : kCommands) *next++ = {joint, command, nullptr, gearing};
  return all;
}

/// Its place among them, whatever its channels.
constexpr std::size_t index_of(Vocabulary vocabulary) {
  const auto gearing = static_cast<std::size_t>(vocabulary.gearing),
             joint = static_cast<std::size_t>(vocabulary.joint),
             command = static_cast<std::size_t>(vocabulary.command);
  return (gearing * std::size(kJoints) + joint) * std::size(kCommands) + command;
}

/// Something that is made of a vocabulary when it is first asked for, and stays. Safe to use by
/// several threads.
template <class Made>
class PerVocabulary {
 public:
  template <class Make>
  const Made& of(Vocabulary vocabulary, Make&& make) {
    const std::lock_guard lock(mutex_);
    const std::pair key(index_of(vocabulary), vocabulary.channels);
    auto known = made_.find(key);
    if (known == made_.end()) known = made_.emplace(key, make(vocabulary)).first;
    return known->second;
  }

 private:
  std::mutex mutex_;
  std::map<std::pair<std::size_t, Channels>, Made> made_;
};

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

/// A quantity with its symbol ("F_c": "T_c"), unit, meaning and range on the machine. One that is
/// related to a channel has the channel's name for a symbol: "channel_force.temperature", in N/K.
Quantity quantity_on(Vocabulary vocabulary, const Quantity& quantity);

}  // namespace axisfit
