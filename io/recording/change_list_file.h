// Lists of changes: one row for every change of one of many signals.
#pragma once

#include <string>
#include <string_view>

#include "io/recording/table.h"

namespace axisfit {

/// Whether a text begins with the names of a time, a key and a value, and a key that is no number
/// follows: "Timestamp,Key,Value", as AdvantageScope exports (CSV, list), or "[Timestamp];[NAME];
/// [VALUE]", as the database server of TwinCAT writes.
bool is_change_list(std::string_view beginning);

/// Makes a column of every key, in the order in which they come first, with the times of its own
/// values; keys that change together share them. Times are in s where they are dates, or of a
/// column that is called "Timestamp"; of others the unit is not known. A key with a value that is
/// no number has an obstacle, which says where. Throws RecordingError naming the line where a row
/// has no time or no key, and where there are no rows.
Table read_change_list(const std::string& path);

}  // namespace axisfit
