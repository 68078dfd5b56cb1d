// One entry of a job file's `recordings`.
#pragma once

#include "fit/data/job.h"
#include "io/config/recording_series.h"
#include "sim/rig.h"

namespace axisfit {

/// Reads a recording and its file, for an axis. With diagnostics where anything is wrong; what is
/// returned then is not to be used.
Recording read_recording(const ConfigNode& node, const Rig& rig, const RecordingSources& sources);

}  // namespace axisfit
