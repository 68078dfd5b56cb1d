// XML as the targets write it.
#pragma once

#include <initializer_list>
#include <pugixml.hpp>
#include <string>
#include <utility>
#include <vector>

namespace axisfit {

/// With all digits that it needs.
std::string number(double value);

/// Of an XML document with comments before it.
std::string xml_text(const pugi::xml_document& document);

/// Where the document is from, and what it lacks.
void add_comments(pugi::xml_node node, const std::string& origin,
                  const std::vector<std::string>& lost);

/// A new node at the end, with attributes.
pugi::xml_node child(pugi::xml_node parent, const char* name,
                     std::initializer_list<std::pair<const char*, std::string>> attributes = {});

}  // namespace axisfit
