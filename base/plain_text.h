// Text from user files for messages and line-based files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace axisfit {

/// The offset of the first byte that is not UTF-8 (RFC 3629: no overlong forms, no surrogates), or
/// npos.
std::size_t find_invalid_utf8(std::string_view text);

/// A text as one line that every reader takes: what breaks lines, controls a terminal, reverses the
/// direction of the text or is no UTF-8 becomes a question mark.
std::string sanitized(std::string_view text);

/// The same line by line: line breaks stay.
std::string sanitized_lines(std::string_view text);

/// Whether sanitized() leaves a text as it is.
bool is_sanitized(std::string_view text);

/// The text; of a long one as many whole characters as fit so many bytes, and "...".
std::string shortened(std::string_view text, std::size_t most = 60);

/// The same in single quotes: what was read may be of any length.
std::string in_quotes(std::string_view text);

}  // namespace axisfit
