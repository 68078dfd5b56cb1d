// What drives the axis in a recording.
#pragma once

#include <optional>

#include "fit/data/job.h"
#include "io/config/recording_series.h"
#include "sim/rig.h"

namespace axisfit {

/// A command in the unit of the drive, for a force source also a recorded force, or a position
/// reference; what else is known of it goes into the recording. Nothing, with diagnostics, unless
/// it fits the times.
std::optional<Series> read_input(const ConfigNode& signals_node, ConfigMap& signals, const Rig& rig,
                                 SeriesReader& series, Recording& recording);

}  // namespace axisfit
