// How the lines of a recording in text are laid out: what the layouts of loggers, spreadsheets and
// the tools of drives have in common.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/column.h"

namespace axisfit {

/// A line, or a row of a worksheet.
struct TextRow {
  std::size_t line = 0;  ///< in the file, from 1
  std::vector<std::string> fields;
  bool balanced = true;     ///< see split_fields
  bool is_comment = false;  ///< whose mark was taken off: it may hold names, but no data
};

struct TextLayout {
  char separator = ',';
  std::vector<Column> columns;    ///< without values; an unnamed column has an empty name
  std::vector<double> intervals;  ///< s, of a column that counts samples; 0 of all others
  std::size_t first_row = 0;      ///< index of the first row of data among those given
  char decimal = '.';             ///< the mark that numbers with a fraction have
  bool series_end_early = false;  ///< rows may have fewer fields: some series have fewer samples
};

/// The separator of a text of which these are the first lines: comma, semicolon or tab, or else
/// blanks, colon or bar.
char find_separator(const std::vector<std::string>& lines);

/// The layout of a recording of which these are the first rows, without blank ones. Above the data
/// may stand:
///   - nothing: the columns have numbers only;
///   - a row of names, and below it one of units; above them any text;
///   - two rows of names, of which the upper ones are generic ("Analog 1"), as Mitsubishi's MR
///     Configurator writes them;
///   - rows that each begin with what they hold, again before every series: TwinCAT Scope, and
///     LabVIEW with its columns that count samples.
/// Throws RecordingError where there are no data, or where names and data do not go together.
TextLayout find_layout(const std::string& path, const std::vector<TextRow>& rows, char separator);

/// Throws the RecordingError of a row that has more or fewer fields than there are columns.
[[noreturn]] void throw_wrong_field_count(const std::string& path, const TextRow& row,
                                          const std::vector<Column>& columns, char separator);

}  // namespace axisfit
