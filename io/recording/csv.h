#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "io/recording/table.h"

namespace axisfit {

// Reads a file of numbers separated by commas; by semicolons or tabs if the header has no comma.
// The first line that is no comment names the columns, or the last comment, if numbers follow it;
// the next one may have their units (it does, if none of its
// fields is a number), every further one holds one finite number per column. Comments stand above
// the names and begin with '#', '%' or "//". The locale does not
// matter: numbers have a decimal point, or, where commas do not separate them, all of them that
// are not whole a decimal comma; no thousands separators. Fields may be quoted and surrounded by
// blanks; a UTF-8 byte-order mark, CRLF line ends, a separator at the end of every line, and blank
// lines at the end of the file are accepted.
//
// Throws RecordingError naming line and column for anything else: no such file, no header (also:
// only numbers in the first line), no rows, empty or repeated column names, a row with too few or
// too many fields, fields that are empty, no number, not finite or beyond the range of a double,
// decimal points and decimal commas in one file.
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
