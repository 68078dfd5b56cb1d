// Logs of halscope, the oscilloscope of LinuxCNC.
#pragma once

#include <string>
#include <string_view>

#include "io/recording/table.h"

namespace axisfit {

/// Whether a text begins with the sampling period, as halscope writes it.
bool is_halscope(std::string_view beginning);

/// Reads the channels of a log as columns, and the times that follow from the sampling period as
/// the column "time" in s. Both layouts are read: names in a line above the values, and, of older
/// versions, a name before every value; of these the last row is left out, since halscope wrote one
/// more than it had recorded. Throws RecordingError naming the line where something else
/// stands, and where there are no samples.
Table read_halscope(const std::string& path);

}  // namespace axisfit
