// What the fields of a line of text hold.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace axisfit {

/// Splits a line at every separator, or at every run of blanks where that is the separator. Fields
/// lose the blanks and the double quotes around them; inside quotes separators are text and two
/// quotes are one. False where quotes are not balanced: then the last field holds the rest of the
/// line as it is.
bool split_fields(std::string_view line, char separator, std::vector<std::string>& fields);

enum class FieldKind {
  number,
  missing,       ///< blank, or a word for no value: NaN, NA, N/A, null, none, -, #N/A
  text,          ///< anything else
  infinite,      ///< a number that is not finite
  out_of_range,  ///< beyond a double
};

/// Takes a field for a number: with a decimal point or the decimal mark given, an optional sign and
/// exponent; true and false are one and zero; a date or a time of day is what parse_time makes of
/// it. `value` is NaN for anything but a number. Whatever the locale.
FieldKind read_field(std::string_view field, char decimal, double& value);

/// A date with a time, in s since 1970-01-01 UTC, or a time of day, in s since midnight: ISO 8601
/// ("2026-03-16T17:04:51.123Z", with a blank for the T, a comma for the point, any offset) or
/// "17:04:51.123". Times without an offset count as UTC.
std::optional<double> parse_time(std::string_view text);

/// Whether a text names a unit, perhaps in brackets: one that udunits knows, or a word of the trade
/// such as "counts" or "U/min".
bool is_unit(std::string_view text);

/// The text without the brackets around it.
std::string_view without_brackets(std::string_view text);

std::string_view trimmed(std::string_view text);

}  // namespace axisfit
