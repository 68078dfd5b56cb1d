#include "exports/xml.h"

#include <gtest/gtest.h>

#include <string>

namespace axisfit {
namespace {

TEST(Xml, NumbersHaveTheDigitsThatTheyNeed) {
  EXPECT_EQ(number(0.1), "0.1");
  EXPECT_EQ(number(1.0 / 3.0), "0.3333333333333333");
  EXPECT_EQ(number(20.0), "20");
}

TEST(Xml, HasAttributesInTheirOrder) {
  pugi::xml_document document;
  const pugi::xml_node body = child(document, "body", {{"name", "a < b"}, {"mass", number(2.5)}});
  child(body, "joint");
  EXPECT_EQ(xml_text(document),
            "<?xml version=\"1.0\"?>\n<body name=\"a &lt; b\" mass=\"2.5\">\n  <joint />\n"
            "</body>\n");
}

// The standard forbids two hyphens, which names and dashes may have.
TEST(Xml, NoTextEndsAComment) {
  pugi::xml_document document;
  add_comments(document, "of a--b", {"x --> y", "-----"});
  child(document, "body");
  const std::string text = xml_text(document);
  pugi::xml_document again;
  ASSERT_TRUE(again.load_string(text.c_str(), pugi::parse_full)) << text;
  int comments = 0;
  for (const pugi::xml_node node : again)
    if (node.type() == pugi::node_comment) {
      ++comments;
      EXPECT_EQ(std::string(node.value()).find("--"), std::string::npos) << node.value();
    }
  EXPECT_EQ(comments, 3);
  EXPECT_NE(text.find("<!-- of a- b -->"), std::string::npos) << text;
}

}  // namespace
}  // namespace axisfit
