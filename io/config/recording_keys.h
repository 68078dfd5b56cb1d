// What a recording of a job file may have, as keys.
#pragma once

#include <cstdint>
#include <string_view>

#include "io/config/config.h"

namespace axisfit {

/// How often a value may be recorded.
inline constexpr std::int64_t kMostHeld = 100000;
/// V
inline constexpr double kLeastSupply = 1e-3, kMostSupply = 1e5;

/// How the loop around a recorded reference is closed, in the order of its words.
enum class Loop { computed, simulated };

/// The keys of a recording, of one of its signals, and of a channel's column.
const Section& recording_keys();
const Section& measurement_keys(std::string_view signal);
const Section& channel_column_keys();

/// A standard deviation, above zero: how it is described, and how it is read.
NumberWithUnit sigma_form(std::string_view unit);
double read_sigma(const ConfigNode& node, std::string_view unit);

}  // namespace axisfit
