// Traces of CODESYS, and of the tools that are made of it (Machine Expert, MOVIRUN, ctrlX).
#pragma once

#include <string>
#include <string_view>

#include "io/recording/table.h"

namespace axisfit {

/// Whether a text begins as a trace that was saved as .trace (XML) or .csv ("[key]; [value]").
/// Saved as .txt it is a table like others.
bool is_codesys(std::string_view beginning);

/// Reads the variables of a trace as columns, with the times of each: in ms, or in us where the
/// trace says so. In .csv without either flag the times have no unit. A variable of several records
/// has "(2)" behind its name in the second. What is no number, or has not as many times as values,
/// is an obstacle. Throws RecordingError where the file is damaged or has no values.
Table read_codesys(const std::string& path);

}  // namespace axisfit
