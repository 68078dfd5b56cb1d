#pragma once

#include <array>

#include "sim/effects/slots.h"
#include "sim/scalar.h"

namespace axisfit {

/// What a channel changes.
enum class Influence { force, dry_friction, viscous_friction, gain, mass };

/// What an effect of channels is called, and what its strengths are.
struct InfluenceInfo {
  std::string_view name, meaning;
  ActsOn acts_on;
  std::string_view unit;         ///< of a strength, times that of its channel
  std::string_view per_channel;  ///< a strength, in words; ends with "channel"
  double typical;
};
inline constexpr InfluenceInfo kInfluences[]{
    {"channel_force", "force in proportion to a recorded channel", ActsOn::arm_force, "N",
     "force per channel", 20.0},
    {"channel_friction", "dry friction that changes with a recorded channel", ActsOn::friction, "N",
     "dry friction per channel", 8.0},
    {"channel_damping", "viscous friction that changes with a recorded channel", ActsOn::friction,
     "N s/m", "viscous friction per channel", 60.0},
    {"channel_gain", "drive force per signal that changes with a recorded channel",
     ActsOn::motor_torque, "1", "relative change of the drive force per channel", 0.1},
    {"channel_mass", "mass that changes with a recorded channel", ActsOn::inertia, "kg",
     "mass per channel", 8.0},
};

/// Something of the axis that changes in proportion to the recorded channels. With c the values of
/// the channels beyond their zero and s the sum of k_j c_j, it is
///
///   force              s, on the arm
///   dry friction       s, added to all other, at rest too
///   viscous friction   s, added to B_a
///   gain               the relative change of the drive's force or torque
///   mass               s, added to M: the momentum of the arm is (M + s) y1
///
/// Source of the momentum: the Lagrangian of an arm whose inertia depends on the place of another
/// axis; e.g. M. W. Spong, S. Hutchinson and M. Vidyasagar, Robot Modeling and Control, ch. 7.
template <class T, Influence kInfluence>
struct ChannelEffect {
  static constexpr const InfluenceInfo& kInfo = kInfluences[static_cast<std::size_t>(kInfluence)];
  static constexpr std::string_view name = kInfo.name;
  static constexpr std::string_view meaning = kInfo.meaning;
  static constexpr ActsOn acts_on = kInfo.acts_on;
  static constexpr std::string_view excitation = "like motion while the channel changes";

  std::array<T, kChannels> k;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    constexpr double kMost = 1e9;
    for (std::size_t j = 0; j < kChannels; ++j)
      visit(Quantity{kSymbols[j], kInfo.unit, kInfo.per_channel, -kMost, kMost, 0.0}
                .of_channel(j)
                .typically(kInfo.typical),
            self.k[j]);
  }

  static std::vector<SearchEntry> search(const SearchScales&) {
    std::vector<SearchEntry> entries;
    for (const std::string_view symbol : kSymbols) {
      SearchEntry entry{.strengths = {symbol}};
      entry.changes_dry_friction = kInfluence == Influence::dry_friction;
      entries.push_back(std::move(entry));
    }
    return entries;
  }

  T arm_force(const Instant<T>& at) const
      requires(kInfluence == Influence::force || kInfluence == Influence::viscous_friction) {
    return kInfluence == Influence::force ? sum(at) : -sum(at) * at.velocity;
  }
  T friction_curve(const Instant<T>& at) const requires(kInfluence == Influence::dry_friction) {
    return sum(at);
  }
  T motor_torque(const Instant<T>& at) const requires(kInfluence == Influence::gain) {
    return sum(at) * at.drive_torque;
  }
  T mass(const Instant<T>& at) const requires(kInfluence == Influence::mass) { return sum(at); }
  T mass_rate(const Instant<T>& at) const requires(kInfluence == Influence::mass) {
    return sum_of(at, [&](std::size_t j) { return T(at.channels->slope[j]); });
  }

 private:
  static constexpr std::array<std::string_view, kChannels> kSymbols{"k_1", "k_2", "k_3", "k_4"};

  T sum(const Instant<T>& at) const {
    return sum_of(at, [&](std::size_t j) { return at.channels->at(j, at.time); });
  }
  template <class Value>
  T sum_of(const Instant<T>& at, Value&& value) const {
    T total(0.0);
    if (at.channels == nullptr) return total;
    for (std::size_t j = 0; j < kChannels; ++j)
      if (is_active(k[j])) total += k[j] * value(j);
    return total;
  }
};

template <class T>
using ChannelForce = ChannelEffect<T, Influence::force>;
template <class T>
using ChannelFriction = ChannelEffect<T, Influence::dry_friction>;
template <class T>
using ChannelDamping = ChannelEffect<T, Influence::viscous_friction>;
template <class T>
using ChannelGain = ChannelEffect<T, Influence::gain>;
template <class T>
using ChannelMass = ChannelEffect<T, Influence::mass>;

}  // namespace axisfit
