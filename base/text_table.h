// Text for a terminal: columns, paragraphs and numbers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace axisfit {

inline constexpr std::size_t kTextWidth = 80;  ///< characters in a line that nobody has to scroll

/// How a column is set.
enum class Alignment {
  left,
  right,
  wrapped,  ///< left, and broken at blanks where the line would be too long; the last column only
};

/// Its width in characters, which may have several bytes; codes that set colour have none.
std::size_t width_of(std::string_view text);

/// Rows as columns, a line or more for each, all ending with '\n'. Where lines would be too long, a
/// first cell that is the reason stands on a line of its own, above the others.
std::string format_table(const std::vector<std::vector<std::string>>& rows,
                         const std::vector<Alignment>& alignment);

/// A paragraph, broken at blanks, each line after `indent` blanks and ending with '\n'.
std::string paragraph(const std::string& text, std::size_t indent = 0);

/// A value with as many digits as its standard error justifies: two of the error.
std::string with_digits_of(double value, double error);

}  // namespace axisfit
