// Channels: what was recorded beside an axis and may act on it, such as a temperature, the voltage
// of its supply, or the motion of a neighbour.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "sim/command.h"

namespace axisfit {

/// The most channels that an axis may have.
inline constexpr std::size_t kChannels = 4;

struct Channel {
  std::string name;   ///< as in "channel_force.temperature"
  std::string unit;   ///< in which its values are given; "1" where it has none
  double zero = 0.0;  ///< the value at which it does nothing

  auto operator<=>(const Channel&) const = default;
};

/// The channels of an axis, by their place.
using ChannelList = std::vector<Channel>;

/// A channel at the instants of a simulation, beyond its zero, in its unit.
struct ChannelSeries {
  std::vector<double> values;
  Hold hold = Hold::linear;  ///< zero_order: the values are those from an instant to the next
};

/// How all channels run from one instant on: straight. Values are beyond their zero.
struct ChannelCourse {
  double since = 0.0;  ///< s
  std::array<double, kChannels> value{};
  std::array<double, kChannels> slope{};  ///< per second

  template <class T>
  T at(std::size_t channel, const T& time) const {
    return value[channel] + slope[channel] * (time - since);
  }
};

}  // namespace axisfit
