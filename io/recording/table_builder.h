// A table made of rows of text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/recording/table.h"
#include "io/recording/text_layout.h"

namespace axisfit {

class TableBuilder {
 public:
  TableBuilder(const std::string& path, TextLayout layout);

  /// Makes room, so that the columns do not have to be moved while they grow.
  void expect_rows(std::size_t rows);

  /// Takes a line that holds nothing but numbers and separators, as nearly all do, in one go. Of
  /// any other it takes nothing and returns false.
  bool add_plain(std::string_view line, std::size_t number);

  /// Takes a row of data, blank fields being missing values. A row of text alone may end the file,
  /// as "EOF". Throws RecordingError where data follow that, and where the number of fields is
  /// wrong.
  void add(const TextRow& row);

  /// The table, without unnamed columns that hold nothing. Throws RecordingError without any row.
  Table finish();

 private:
  void add_field(std::size_t column, const std::string& field, std::size_t line);

  Table table_;
  TextLayout layout_;
  std::size_t text_line_ = 0;  ///< of text alone; 0: none yet
  std::string text_;
};

}  // namespace axisfit
