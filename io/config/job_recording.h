// One entry of a job file's `recordings`.
#pragma once

#include <string>

#include "fit/data/job.h"
#include "io/config/recording_series.h"
#include "sim/rig.h"

namespace axisfit {

/// Reads a recording and its file, for an axis and the observer of the fit. With diagnostics where
/// anything is wrong; what is returned then is not to be used.
Recording read_recording(const ConfigNode& node, const Rig& rig, ObserverMode observer,
                         const RecordingSources& sources);

/// Why a quantity has no influence on a recording under a fixed observer gain: it is the lag or the
/// delay of the signal that the simulation tracks. Empty where it has influence.
std::string ignored_by_observer(const QuantityEntry& entry, ObserverMode observer,
                                const Recording& recording);

}  // namespace axisfit
