// A column of a recording as a configuration file describes it.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "io/config/config.h"
#include "io/recording/recording_file.h"

namespace axisfit {

/// The keys of a column.
const Section& column_keys();

/// One column in SI units, from a map {column: name, unit: mm/s, sign: -1, factor: 2}: the stored
/// values times factor and sign, converted from the unit. Nothing when something is wrong; that has
/// been said. The caller finishes the map, which may have more keys.
std::optional<std::vector<double>> read_column(const RecordingFile& file, ConfigMap& map,
                                               std::string_view si_unit);

/// The same from a map that has no other keys.
std::optional<std::vector<double>> read_column(const RecordingFile& file, const ConfigNode& node,
                                               std::string_view si_unit);

/// Whether a row says nothing but what the row before says, its time among it: loggers write some
/// rows twice.
bool repeats_row(const RecordingFile& file, std::size_t row);

/// The times of the samples, s, NaN where there is none, and in rows that repeat the row before;
/// they must increase: nothing, with a diagnostic, otherwise.
std::optional<std::vector<double>> read_times(const RecordingFile& file, const ConfigNode& node);

}  // namespace axisfit
