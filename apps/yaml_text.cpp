#include "apps/yaml_text.h"

#include <fmt/format.h>

#include <string_view>

#include "apps/config.h"
#include "apps/text_table.h"

namespace axisfit {
std::string harmless(const std::string& text) {
  std::string result = text;
  for (std::size_t at; (at = find_invalid_utf8(result)) != std::string::npos;) result[at] = '?';
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  // The other control characters of Unicode, and what separates its lines and paragraphs.
  for (std::size_t i = 0; i + 1 < result.size(); ++i) {
    const std::string_view rest = std::string_view(result).substr(i);
    const bool control = rest[0] == '\xC2' && static_cast<unsigned char>(rest[1]) < 0xA0;
    const bool separator = rest.starts_with("\u2028") || rest.starts_with("\u2029");
    if (!control && !separator) continue;
    result[i] = '?';
    result.erase(i + 1, control ? 1 : 2);
  }
  return result;
}

bool is_harmless(const std::string& text) { return harmless(text) == text; }

std::string comment(const std::string& text, std::size_t indent) {
  std::string lines = paragraph(harmless(text), indent + 2);
  for (std::size_t at = 0; at < lines.size(); at = lines.find('\n', at) + 1)
    lines[at + indent] = '#';
  return lines;
}

std::string scalar(const std::string& text) {
  YAML::Emitter out;
  out << text;
  return out.c_str();
}

double two_digits(double value) { return std::stod(fmt::format("{:.2g}", value)); }

}  // namespace axisfit
