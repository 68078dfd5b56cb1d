// Recorded columns from a CSV file or a MATLAB file.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/config/config.h"

namespace axisfit {

/// A recording as stored: named columns, whatever the format.
class RecordingFile {
 public:
  /// Reads `path`: MATLAB format if its name ends in ".mat", CSV otherwise. Throws RecordingError.
  explicit RecordingFile(const std::string& path);

  /// The values of a column (CSV) or variable (MATLAB); null with a diagnostic at `name` that lists
  /// what there is.
  const std::vector<double>* column(const ConfigNode& name) const;

  /// All columns by name; those of a MATLAB file may differ in length and hold what is not finite.
  const std::map<std::string, std::vector<double>>& columns() const { return columns_; }

  /// What a row of units below the header says of a column; empty where there is none.
  std::string unit(const std::string& column) const;

  /// "file:17" or "file: row 17", for messages about the row with this index.
  std::string where(std::size_t row) const;

 private:
  std::string path_;
  std::map<std::string, std::vector<double>> columns_;
  std::map<std::string, std::string> units_;
  std::map<std::string, std::string> ignored_;  // variable, why it is no column
  std::vector<std::size_t> lines_;              // of the rows
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

/// The times of the samples, s, which must increase; nothing, with a diagnostic, otherwise.
std::optional<std::vector<double>> read_times(const RecordingFile& file, const ConfigNode& node);

}  // namespace axisfit
