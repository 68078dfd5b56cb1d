#include "base/terminal.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace axisfit {
namespace {

TEST(Terminal, SetsHeadingsBold) {
  EXPECT_EQ(with_bold_headings("Parameters\n  V_L  2.7  V\n\nUsable fit: reduced\nchi-square 1.\n"),
            "\033[1mParameters\033[0m\n  V_L  2.7  V\n\nUsable fit: reduced\nchi-square 1.\n");
}

TEST(Terminal, ColoursWordsByTheirTone) {
  EXPECT_EQ(toned("Usable fit", Tone::good, true), "\033[32mUsable fit\033[0m");
  EXPECT_EQ(toned("at bound", Tone::caution, true), "\033[33mat bound\033[0m");
  EXPECT_EQ(toned("No usable fit", Tone::bad, true), "\033[31mNo usable fit\033[0m");
  EXPECT_EQ(toned("rejected", Tone::neutral, true), "rejected");
  EXPECT_EQ(toned("No usable fit", Tone::bad, false), "No usable fit");
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
