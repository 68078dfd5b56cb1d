// Formatting for terminals. Pipes and files get plain text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace axisfit {

/// Whether a file descriptor is a terminal that can clear a line and set type: TERM is not dumb.
bool is_terminal(int file);

/// The same, and NO_COLOR (no-color.org) is not set.
bool takes_colour(int file);

/// Columns of the terminal; without one those of COLUMNS, or 80.
std::size_t terminal_width(int file);

/// Characters in a line of text written there: those of a terminal narrower than kTextWidth, else
/// that.
std::size_t text_width(int file);

/// What a coloured word stands for: green, yellow or red.
enum class Tone { neutral, good, caution, bad };

/// Words in the colour of their tone; without `colour`, as they are.
std::string toned(std::string_view words, Tone tone, bool colour);

/// A text with its headings bold: lines at the margin, above what is indented.
std::string with_bold_headings(const std::string& text);

}  // namespace axisfit
