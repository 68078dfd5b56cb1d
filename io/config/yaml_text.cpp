#include "io/config/yaml_text.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "base/plain_text.h"
#include "base/text_table.h"

namespace axisfit {

std::string comment(const std::string& text, std::size_t indent) {
  std::string lines = paragraph(sanitized(text), indent + 2);
  for (std::size_t at = 0; at < lines.size(); at = lines.find('\n', at) + 1)
    lines[at + indent] = '#';
  return lines;
}

std::string scalar(const std::string& text) {
  YAML::Emitter out;
  out << text;
  return out.c_str();
}

}  // namespace axisfit
