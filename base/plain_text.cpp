#include "base/plain_text.h"

#include <algorithm>

namespace axisfit {
namespace {

// Whether a byte of UTF-8 text continues a character.
bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

// The bytes of a control character at the start of valid UTF-8, of one that separates lines or
// paragraphs, or of one that reorders what follows (Unicode's bidirectional formatting); 0 where
// there is none.
std::size_t control_size(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x20 || byte(0) == 0x7F) return 1;
  if (byte(0) == 0xC2 && byte(1) < 0xA0) return 2;
  if (byte(0) == 0xD8 && byte(1) == 0x9C) return 2;  // U+061C
  if (byte(0) != 0xE2) return 0;
  const unsigned last_two = byte(1) << 8 | byte(2);
  const bool separates = last_two == 0x80A8 || last_two == 0x80A9;     // U+2028, U+2029
  const bool reorders = last_two == 0x808E || last_two == 0x808F ||    // U+200E, U+200F
                        (last_two >= 0x80AA && last_two <= 0x80AE) ||  // U+202A to U+202E
                        (last_two >= 0x81A6 && last_two <= 0x81A9);    // U+2066 to U+2069
  return separates || reorders ? 3 : 0;
}

}  // namespace

std::size_t find_invalid_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[i + k]); };
    const unsigned lead = byte(0);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xC2 ? 0
                               : lead < 0xE0 ? 2
                               : lead < 0xF0 ? 3
                               : lead < 0xF5 ? 4
                                             : 0;
    if (length == 0 || length > text.size() - i) return i;
    for (std::size_t k = 1; k < length; ++k) {
      if (!is_continuation(text[i + k])) return i;
    }
    if (length > 2) {
      const unsigned first_two = lead << 8 | byte(1);
      const bool overlong =
          (lead == 0xE0 && first_two < 0xE0A0) || (lead == 0xF0 && first_two < 0xF090);
      const bool surrogate = lead == 0xED && first_two >= 0xEDA0;
      if (overlong || surrogate || first_two >= 0xF490) return i;
    }
    i += length;
  }
  return std::string_view::npos;
}

std::string sanitized(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t valid = std::min(find_invalid_utf8(text), text.size());
    for (std::string_view remaining = text.substr(0, valid); !remaining.empty();) {
      const std::size_t control = control_size(remaining);
      result += control > 0 ? '?' : remaining.front();
      remaining.remove_prefix(std::max<std::size_t>(control, 1));
    }
    if (valid < text.size()) result += '?';
    text.remove_prefix(std::min(valid + 1, text.size()));
  }
  return result;
}

std::string sanitized_lines(std::string_view text) {
  std::string result;
  for (std::size_t end; (end = text.find('\n')) != std::string_view::npos;) {
    result += sanitized(text.substr(0, end)) + '\n';
    text.remove_prefix(end + 1);
  }
  return result + sanitized(text);
}

bool is_sanitized(std::string_view text) { return sanitized(text) == text; }

std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  while (most > 0 && is_continuation(text[most])) --most;
  return std::string(text.substr(0, most)) + "...";
}

std::string in_quotes(std::string_view text) { return "'" + shortened(text) + "'"; }

}  // namespace axisfit
