// Recorded columns from a file of any format.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/config/config.h"
#include "io/recording/table.h"

namespace axisfit {

/// A recording as stored: columns, whatever the format.
class RecordingFile {
 public:
  /// Reads `path` as what its name ends in: .mat, .xlsx, .mcap, or anything else as text. Throws
  /// RecordingError.
  explicit RecordingFile(const std::string& path);
  /// What another program holds in memory.
  explicit RecordingFile(Table table) : table_(std::move(table)) {}

  /// The column of this name, or with this number from 1; null with a diagnostic at `name` that
  /// says what is wrong with it or lists what there is.
  const Column* column(const ConfigNode& name) const;

  /// All columns; those of a MATLAB file may differ in length.
  const std::vector<Column>& columns() const { return table_.columns; }

  /// What a job calls a column: its name, or its number where it has none of its own.
  std::string reference(std::size_t column) const;

  /// "file:17" or "file: row 17", for messages about the row with this index.
  std::string where(std::size_t row) const { return table_.where(row); }

 private:
  void say_missing(const ConfigNode& node, const std::string& name) const;

  Table table_;
};

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

/// s; beside the times themselves, shorter ones are rounding.
inline constexpr double kShortestStep = 1e-9;

/// The times of the samples, s, NaN where there is none; they must increase: nothing, with a
/// diagnostic, otherwise.
std::optional<std::vector<double>> read_times(const RecordingFile& file, const ConfigNode& node);

}  // namespace axisfit
