// One entry of a job file's `recordings`.
#pragma once

#include <string>

#include "fit/data/job.h"
#include "io/config/config.h"
#include "io/recording/table.h"
#include "sim/rig.h"

namespace axisfit {

/// The keys of a recording.
const Section& recording_keys();

/// Where recordings come from.
struct RecordingSources {
  std::string folder{};  ///< below which relative paths are; empty: that of the job file
  Tables tables{};       ///< instead of files of these names
};

/// Reads a recording and its file, for an axis and the observer of the fit. With diagnostics where
/// anything is wrong; what is returned then is not to be used.
Recording read_recording(const ConfigNode& node, const Rig& rig, ObserverMode observer,
                         const RecordingSources& sources);

/// Why a quantity has no influence on a recording under a fixed observer gain: it is the lag or the
/// delay of the signal that the simulation tracks. Empty where it has influence.
std::string ignored_by_observer(const QuantityEntry& entry, ObserverMode observer,
                                const Recording& recording);

/// The path of a file named in a configuration file: relative to `base`, or else to the folder of
/// that file.
std::string resolved(const ConfigNode& node, const std::string& file, const std::string& base);

/// A standard deviation, above zero: how it is described, and how it is read.
NumberWithUnit sigma_form(std::string_view unit);
double read_sigma(const ConfigNode& node, std::string_view unit);

}  // namespace axisfit
