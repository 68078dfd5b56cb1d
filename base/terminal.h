// What a terminal gets beyond plain text. Pipes and files never get any of it.
#pragma once

#include <cstddef>
#include <string>

namespace axisfit {

/// Whether a file descriptor is a terminal that can clear a line and set type: TERM is not dumb.
bool is_terminal(int file);

/// The same, and nobody asked by NO_COLOR (no-color.org) to have no colours.
bool takes_colour(int file);

/// Columns of the terminal; without one those of COLUMNS, or 80.
std::size_t terminal_width(int file);

/// A report (report_text.h) for a terminal: headings bold, verdicts green, yellow or red.
std::string coloured(const std::string& report);

}  // namespace axisfit
