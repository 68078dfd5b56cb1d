#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "io/recording/table.h"

namespace axisfit {

// Reads a recording in text, in any of the layouts of text_layout.h: UTF-8, UTF-16 or Western
// Windows, plain or gzipped, with LF or CR LF. Commas, semicolons or tabs separate the fields, or
// else blanks, colons or bars. Fields may be quoted and surrounded by blanks. Numbers have a
// decimal point, or, where commas do not separate them, all of them that are not whole a decimal
// comma, whatever the locale; no thousands separators. What else a field may be says read_field in
// text_fields.h; missing values are NaN. Comments begin with '#', '%' or "//". Blank lines and
// separators at the end of lines do not count.
//
// A column with text in it has an obstacle, which says where. A column without a name has an empty
// one; names may repeat. Series with times of their own have a clock.
//
// Throws RecordingError naming the line for anything else: no such file, another format, no rows,
// rows with too few or too many fields, text between rows, quotes that are not balanced.
Table read_csv(const std::string& path);

// Writes the header and the rows with commas and LF. Each number takes the fewest digits that read
// back as exactly the same double, or `significant_digits` (1 to 17) of them, trailing zeros left
// out, when that is not 0. NaN stands for "no value here" and becomes an empty field, which
// read_csv refuses, as it refuses the "inf" of infinite numbers.
//
// Throws std::logic_error if the columns differ in length or the number of digits is out of range.
// Failures of the stream are left in its state for the caller to check.
void write_csv(std::ostream& out, const std::vector<Column>& columns, int significant_digits = 0);

}  // namespace axisfit
