// Recordings in JSON.
#pragma once

#include <string>
#include <string_view>

#include "io/recording/table.h"

namespace axisfit {

/// Whether a text begins as JSON: with an object, or with an array of objects.
bool is_json(std::string_view beginning);

/// Reads as columns, whatever else the file holds:
///   - rows: an array of objects, in the file or below a key, or an object in every line (JSON
///     Lines), of which the last may be cut off;
///   - arrays of numbers that stand by themselves.
/// A column is called by its path: "motor.current", "q[1]" of an array in a row, of which the first
/// 64 numbers are taken; "data.time" where the rows are below a key. null and what a row lacks are
/// missing values; true and false are one and zero; texts are what read_field of text_fields.h
/// makes of them, or else an obstacle. Columns of several arrays may differ in length.
///
/// Throws RecordingError, with the line where one is known, where the file is no JSON, is nested
/// deeper than 32, holds no numbers, has rows without names or more than 4096 columns, or where
/// nearly all values are missing.
Table read_json(const std::string& path);

}  // namespace axisfit
