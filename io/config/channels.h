// Channels in axis and job files: what was recorded beside an axis and may act on it.
//
//   channels: {temperature: {unit: degC, zero: 25 degC}}                in an axis file
//   channels: {temperature: {column: T_motor, unit: degC}}              of a recording of a job
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fit/data/job.h"
#include "io/config/config.h"

namespace axisfit {

/// What the names of channels, and of the axes of a machine, are, as a regular expression.
inline constexpr std::string_view kChannelName = "^[A-Za-z][A-Za-z0-9_]*$";
/// What quantities that are related to a channel are called, as "channel_force.temperature".
inline constexpr std::string_view kChannelQuantity = "^channel_[a-z]+\\.[A-Za-z][A-Za-z0-9_]*$";

/// Whether a key is such a name; else with a diagnostic that calls it `what`, as "a channel".
bool is_plain_name(const ConfigNode& key, std::string_view what);

/// The channels of an axis.
ChannelList channels_of(const Structure& structure);

/// A quantity that is related to a channel, whose unit nobody knows before.
Form amount_per_channel();

/// The key `channels` of an axis file.
Key axis_channels_key();

/// The unit of the first or second derivative of a column by time; of the zeroth its own.
std::string differentiated(const std::string& unit, int order);
/// That of a column whose derivative has the unit.
std::string integrated(const std::string& unit, int order);

/// Adds one with zero at 0, unless it cannot be, with a diagnostic at its key.
bool add_channel(const ConfigNode& key, std::string unit, ChannelList& channels);

/// Reads it.
void read_channels(const ConfigNode& node, Structure& structure);

/// Adds the channels that recordings of a job have and the axis does not declare.
void add_channels_of(const std::vector<ConfigNode>& recordings, Structure& structure);

/// Puts the zero of those behind the first `declared` where what was fitted is not far: at zero
/// where a channel passes it or touches it, else at its mean. Their values are given as recorded.
void set_channel_zeros(std::size_t declared, Job& job);

}  // namespace axisfit
