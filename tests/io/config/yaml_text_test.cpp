#include "io/config/yaml_text.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <sstream>
#include <string>

namespace axisfit {
namespace {

TEST(YamlText, ACommentIsOneOnEveryLine) {
  EXPECT_EQ(comment("one line", 0), "# one line\n");
  EXPECT_EQ(comment("one line", 4), "    # one line\n");
  const std::string text = comment(std::string(60, 'x') + " " + std::string(60, 'y'), 2);
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count)
    EXPECT_TRUE(line.starts_with("  # ")) << line;
  EXPECT_EQ(count, 2);
}

TEST(YamlText, ACommentCannotEnd) {
  const std::string text = comment("note\nfree: {M: {}}", 0);
  EXPECT_EQ(text, "# note?free: {M: {}}\n");
}

TEST(YamlText, AScalarComesBackAsTheSameText) {
  for (const char* text : {"plain", "true: # x", "- &x *y", "!!null ~", "{a}", "it's \"q\"", " a ",
                           "", "a\nb: c", "null"})
    EXPECT_EQ(YAML::Load("k: " + scalar(text))["k"].as<std::string>(), text) << scalar(text);
  EXPECT_EQ(scalar("plain"), "plain");
}

}  // namespace
}  // namespace axisfit
