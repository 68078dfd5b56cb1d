// Workbooks of Excel (.xlsx): a zip archive of XML.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "io/recording/table.h"

namespace axisfit {

/// Takes the rows of a worksheet one after the other, with one row and the texts that cells share
/// in memory. It is the first worksheet that holds a row.
///
/// A cell is given as a text: numbers as they are stored, formulas as their stored result, true and
/// false as 1 and 0, errors as "#DIV/0!". A date is "2026-03-16T17:04:51.123"; a time of day or a
/// duration is a number of seconds. Neither formulas nor macros are run.
class XlsxRows {
 public:
  /// Throws RecordingError where there is no file, or none of this kind, and where it has no rows.
  explicit XlsxRows(const std::string& path);
  ~XlsxRows();
  XlsxRows(const XlsxRows&) = delete;
  XlsxRows& operator=(const XlsxRows&) = delete;

  /// The next row, blank cells being empty; false at the end of the sheet. Throws RecordingError
  /// where the file is damaged or something in it is impossibly large.
  bool next(std::vector<std::string>& fields);

  /// Of the row returned last, as Excel shows it, from 1.
  std::size_t number() const;

  /// Name of the worksheet.
  const std::string& sheet() const;

 private:
  class Workbook;
  std::unique_ptr<Workbook> workbook_;
};

/// Reads a recording in a workbook, in the layouts of text_layout.h. Throws RecordingError.
Table read_xlsx(const std::string& path);

}  // namespace axisfit
