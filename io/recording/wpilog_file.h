// Data logs of WPILib (.wpilog), as the programs of robots write them.
#pragma once

#include <string>

#include "io/recording/table.h"

namespace axisfit {

/// Whether the file at `path` begins as a data log.
bool is_wpilog(const std::string& path);

/// Reads every number of a data log (version 1) as a column with times of its own, in s since the
/// first of them: the types boolean, int64, float and double, and arrays of them, whose columns are
/// called "name[0]" and so on. What was stopped and started again goes on; where it has another
/// type then, "(2)" follows the name. Records of an array count where they are as long as its first
/// that is not empty.
///
/// Entries of other types, and arrays of more than 64 numbers, are columns with an obstacle. A file
/// whose end is missing, since the robot was switched off, is read as far as it goes. Throws
/// RecordingError where the file is none of this kind, is damaged, or holds no numbers.
Table read_wpilog(const std::string& path);

}  // namespace axisfit
