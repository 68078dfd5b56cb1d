// Text for a terminal: columns, paragraphs and numbers.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace axisfit {

inline constexpr std::size_t kTextWidth = 80;  ///< characters in a line that nobody has to scroll

/// Lines have at most `width` characters instead of kTextWidth as long as this lives, for texts
/// made in its thread: a narrow terminal would break them anywhere. Not below 40.
class TextWidth {
 public:
  explicit TextWidth(std::size_t width);
  ~TextWidth();
  TextWidth(const TextWidth&) = delete;
  TextWidth& operator=(const TextWidth&) = delete;

  static std::size_t now();

 private:
  std::size_t before_;
};

/// How a column is set.
enum class Alignment {
  left,
  right,
  wrapped,  ///< left, and broken at blanks where the line would be too long; the last column only
};

/// Its width in characters, which may have several bytes; codes that set colour have none.
std::size_t width_of(std::string_view text);

/// Rows as columns, a line or more for each, all ending with '\n'. Where lines would be too long, a
/// first cell that is the reason stands on a line of its own, above the others; where that does not
/// help, every row goes on in another line, at the same column.
std::string format_table(const std::vector<std::vector<std::string>>& rows,
                         const std::vector<Alignment>& alignment);

/// A paragraph, broken at blanks, each line after `indent` blanks and ending with '\n'.
std::string paragraph(const std::string& text, std::size_t indent = 0);

/// A value with as many digits as its standard error justifies: two of the error.
std::string with_digits_of(double value, double error);

}  // namespace axisfit
