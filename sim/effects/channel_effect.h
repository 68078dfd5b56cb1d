#pragma once

#include <array>

#include "sim/effects/slots.h"
#include "sim/scalar.h"

namespace axisfit {

/// What a channel changes.
enum class Influence { force, dry_friction, viscous_friction, gain, mass };

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
  static constexpr std::string_view name = [] {
    switch (kInfluence) {
      case Influence::force:
        return "channel_force";
      case Influence::dry_friction:
        return "channel_friction";
      case Influence::viscous_friction:
        return "channel_damping";
      case Influence::gain:
        return "channel_gain";
      case Influence::mass:
        return "channel_mass";
    }
  }();
  static constexpr std::string_view meaning = [] {
    switch (kInfluence) {
      case Influence::force:
        return "force in proportion to a recorded channel";
      case Influence::dry_friction:
        return "dry friction that changes with a recorded channel";
      case Influence::viscous_friction:
        return "viscous friction that changes with a recorded channel";
      case Influence::gain:
        return "drive force per signal that changes with a recorded channel";
      case Influence::mass:
        return "mass that changes with a recorded channel";
    }
  }();
  static constexpr ActsOn acts_on = [] {
    switch (kInfluence) {
      case Influence::force:
        return ActsOn::arm_force;
      case Influence::dry_friction:
      case Influence::viscous_friction:
        return ActsOn::friction;
      case Influence::gain:
        return ActsOn::motor_torque;
      case Influence::mass:
        return ActsOn::inertia;
    }
  }();
  static constexpr std::string_view excitation = "like motion while the channel changes";

  std::array<T, kChannels> k;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    for (std::size_t j = 0; j < kChannels; ++j)
      visit(Quantity{kSymbols[j], kUnit, kPerChannel, -kMost, kMost, 0.0}.of_channel(j).typically(
                kTypical),
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
    T rate(0.0);
    if (at.channels == nullptr) return rate;
    for (std::size_t j = 0; j < kChannels; ++j)
      if (is_active(k[j])) rate += k[j] * at.channels->slope[j];
    return rate;
  }

 private:
  static constexpr std::array<std::string_view, kChannels> kSymbols{"k_1", "k_2", "k_3", "k_4"};
  static constexpr std::string_view kUnit = [] {
    switch (kInfluence) {
      case Influence::force:
      case Influence::dry_friction:
        return "N";
      case Influence::viscous_friction:
        return "N s/m";
      case Influence::gain:
        return "1";
      case Influence::mass:
        return "kg";
    }
  }();
  static constexpr std::string_view kPerChannel = [] {
    switch (kInfluence) {
      case Influence::force:
        return "force per channel";
      case Influence::dry_friction:
        return "dry friction per channel";
      case Influence::viscous_friction:
        return "viscous friction per channel";
      case Influence::gain:
        return "relative change of the drive force per channel";
      case Influence::mass:
        return "mass per channel";
    }
  }();
  static constexpr double kMost = 1e9;
  static constexpr double kTypical = [] {
    switch (kInfluence) {
      case Influence::force:
        return 20.0;
      case Influence::dry_friction:
      case Influence::mass:
        return 8.0;
      case Influence::viscous_friction:
        return 60.0;
      case Influence::gain:
        return 0.1;
    }
  }();

  T sum(const Instant<T>& at) const {
    T total(0.0);
    if (at.channels == nullptr) return total;
    for (std::size_t j = 0; j < kChannels; ++j)
      if (is_active(k[j])) total += k[j] * at.channels->at(j, at.time);
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
