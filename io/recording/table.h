// The columns of a recording, whatever the format of the file.
#pragma once

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/column.h"

namespace axisfit {

/// A recording cannot be used as it is. what() is meant for the person who made the recording: it
/// names the place and says what to do, as "file:line: message", or "file: message" without a line;
/// one line that every terminal shows (plain_text.h).
class RecordingError : public std::runtime_error {
 public:
  /// `line` counts from 1; 0 means that no line is known.
  RecordingError(const std::string& file, std::size_t line, const std::string& message);
};

/// Throws RecordingError unless there is a file at `path` that can be opened: a pipe may never be
/// written to, and a device have no end.
void check_readable(const std::string& path);

/// Columns and where they came from. They may differ in length, names may repeat or be empty.
struct Table {
  std::string file;  ///< the source as it is named in messages
  std::vector<Column> columns;
  std::vector<std::size_t> lines{};  ///< of each row in `file`, from 1; empty: no lines

  /// The length of the longest column, 0 without any.
  std::size_t rows() const;

  /// The first column of exactly this name (case matters), or nullptr. Valid until `columns`
  /// changes.
  const Column* find(std::string_view name) const;

  /// The place of row `row` (from 0) for messages: "file:line", or "file: row N" with N from 1 when
  /// the source has no lines.
  std::string where(std::size_t row) const;
};

/// Appends a series with times of its own: its values and, as their clock, the times. The clock is
/// that of the series before where the times are the same.
void add_series(Table& table, Column times, Column values);

/// Tables by the names by which jobs call them.
using Tables = std::map<std::string, Table>;

}  // namespace axisfit
