#include "exports/xml.h"

#include <fmt/format.h>

#include <sstream>

namespace axisfit {
namespace {

/// XML comments may not contain two hyphens.
void add_comment(pugi::xml_node node, std::string text) {
  for (std::size_t at = 0; (at = text.find("--", at)) != std::string::npos;)
    text.replace(at, 2, "- ");
  node.append_child(pugi::node_comment).set_value((" " + text + " ").c_str());
}

}  // namespace

std::string number(double value) { return fmt::format("{}", value); }

std::string xml_text(const pugi::xml_document& document) {
  std::ostringstream out;
  document.save(out, "  ");
  return out.str();
}

void add_comments(pugi::xml_node node, const std::string& origin,
                  const std::vector<std::string>& lost) {
  add_comment(node, origin);
  for (const std::string& sentence : lost) add_comment(node, sentence);
}

pugi::xml_node child(pugi::xml_node parent, const char* name,
                     std::initializer_list<std::pair<const char*, std::string>> attributes) {
  pugi::xml_node node = parent.append_child(name);
  for (const auto& [key, value] : attributes) node.append_attribute(key) = value.c_str();
  return node;
}

}  // namespace axisfit
