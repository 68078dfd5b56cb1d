#include "base/terminal.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>
#include <string>

namespace axisfit {
namespace {

const std::string kReport =
    "Parameters\n  V_L  2.7  V\n\n  V_L  preamplifier limit: not determined\n\nUsable fit: reduced "
    "chi-square 1 on the fitted data. These recordings do not\ndetermine V_L.\n";

TEST(Terminal, ColoursHeadingsAndVerdictsAndNothingElse) {
  const std::string text = coloured(kReport);
  EXPECT_EQ(std::regex_replace(text, std::regex("\033\\[[0-9;]*m"), ""), kReport);
  EXPECT_TRUE(text.starts_with("\033[1mParameters\033[0m\n  V_L  2.7  V\n")) << text;
  EXPECT_NE(text.find("preamplifier limit: \033[31mnot determined\033[0m\n"), std::string::npos);
  EXPECT_NE(text.find("\n\033[32mUsable fit\033[0m: reduced"), std::string::npos);
  EXPECT_TRUE(text.ends_with("\ndetermine V_L.\n"));
  EXPECT_NE(coloured("No usable fit: why.\n").find("\033[31mNo usable fit\033[0m"),
            std::string::npos);
}

TEST(Terminal, WithoutOneTheWidthIsThatOfColumns) {
  setenv("COLUMNS", "40", 1);
  EXPECT_EQ(terminal_width(-1), 40u);
  setenv("COLUMNS", "no number", 1);
  EXPECT_EQ(terminal_width(-1), 80u);
  unsetenv("COLUMNS");
  EXPECT_EQ(terminal_width(-1), 80u);
  EXPECT_FALSE(is_terminal(-1));
  EXPECT_FALSE(takes_colour(-1));
}

}  // namespace
}  // namespace axisfit
