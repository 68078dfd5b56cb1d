// Recorded columns from a file of any format.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "io/recording/table.h"

namespace axisfit {

/// A recording as stored: columns, whatever the format.
class RecordingFile {
 public:
  /// Reads `path` as what its name ends in: .mat, .xlsx or .mcap; and anything else as what it
  /// begins with: a data log of WPILib, a trace of CODESYS, tests of SysId, a log of halscope,
  /// JSON, a list of changes, or else a table in text. Of a file of several recordings, "#" and the
  /// name of one follow the path: "arm.json#slow-forward". Throws RecordingError.
  explicit RecordingFile(const std::string& path);
  /// What another program holds in memory.
  explicit RecordingFile(Table table) : table_(std::move(table)) {}

  /// The column of this name, or with this number from 1; or, for the user, what is wrong with it
  /// or what there is instead.
  std::variant<const Column*, std::string> column(const std::string& name) const;

  /// All columns; those of a MATLAB file may differ in length.
  const std::vector<Column>& columns() const { return table_.columns; }

  /// What a job calls a column: its name, or its number where it has none of its own.
  std::string reference(std::size_t column) const;

  /// "file:17" or "file: row 17", for messages about the row with this index.
  std::string where(std::size_t row) const { return table_.where(row); }

 private:
  std::string missing(const std::string& name) const;

  Table table_;
};

/// The file that a path of a recording names: without "#" and the name of one recording in it.
std::string file_of_recording(const std::string& path);

}  // namespace axisfit
