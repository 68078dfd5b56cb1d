// Tests of a mechanism that SysId of WPILib has recorded (JSON).
#pragma once

#include <string>
#include <string_view>

#include "io/recording/table.h"

namespace axisfit {

/// Whether a text begins as a file of SysId: a JSON object that soon names one of its tests.
bool is_sysid(std::string_view beginning);

/// Reads one of the tests of a file, "slow-forward", "slow-backward", "fast-forward" and
/// "fast-backward", or in later versions "quasistatic-forward", "quasistatic-reverse",
/// "dynamic-forward" and "dynamic-reverse"; an empty name means the only one that has rows.
///
/// Columns are "time" in s, "motor voltage" in V, "position" and "velocity"; of a drivetrain
/// "left motor voltage" and so on, and "gyro angle" and "gyro rate", whose unit SysId does not say.
/// Motion is multiplied by the units per rotation, as SysId does, and lengths are in m, angles in
/// rad, deg or rev (then the velocity is in rpm), as the file says. Throws RecordingError where the
/// file is damaged, and where the name is missing or not in it: it names those that are.
Table read_sysid(const std::string& path, const std::string& test);

}  // namespace axisfit
