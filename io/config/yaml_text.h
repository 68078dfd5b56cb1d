// Pieces of YAML files that hold text from elsewhere, which must not get out of its place.
#pragma once

#include <cstddef>
#include <string>

namespace axisfit {

inline constexpr const char* kGuessed = "GUESSED: ";  ///< begins a comment on what nothing says

/// Lines "# text", each after `indent` blanks.
std::string comment(const std::string& text, std::size_t indent);

/// A text as a value, quoted where it must be.
std::string scalar(const std::string& text);

}  // namespace axisfit
