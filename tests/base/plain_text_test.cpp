#include "base/plain_text.h"

#include <gtest/gtest.h>

#include <string>

namespace axisfit {
namespace {

TEST(PlainText, WhatIsNoTextBecomesAQuestionMark) {
  for (const char* text : {"", "plain", "Größe µm", "\U0001F600", "a\u00A0b"}) {
    EXPECT_EQ(sanitized(text), text);
    EXPECT_TRUE(is_sanitized(text));
  }
  EXPECT_EQ(sanitized("a\tb\nc\x1B[2J\x7F"), "a?b?c?[2J?");
  EXPECT_EQ(sanitized("\u0085\u009B1m\u2028\u2029\u2030"), "??1m??\u2030");
  EXPECT_EQ(sanitized("\u202Egpj.exe\u2066\u2069\u200F\u061C"), "?gpj.exe????");
  EXPECT_EQ(sanitized("\u200D\u2065\u206A\u061B"), "\u200D\u2065\u206A\u061B");
  EXPECT_EQ(sanitized_lines("a\x1B[2J\n\nb\r\n"), "a?[2J\n\nb?\n");
  EXPECT_EQ(sanitized("gr\xF6\xDF"
                      "er"),
            "gr??er");
  EXPECT_EQ(sanitized("\xC3"), "?");
  EXPECT_EQ(sanitized("\xE2\x80"), "??");
  EXPECT_EQ(sanitized(std::string("\0", 1)), "?");
  EXPECT_FALSE(is_sanitized("\xFF"));
}

TEST(PlainText, IsLinearInTheText) {
  // A second of work at the square of this.
  const std::string wrong(1 << 20, '\xFF'), control = "\u0085";
  EXPECT_EQ(sanitized(wrong), std::string(wrong.size(), '?'));
  std::string many;
  for (int i = 0; i < 1 << 19; ++i) many += control;
  EXPECT_EQ(sanitized(many), std::string(1 << 19, '?'));
}

TEST(PlainText, IsCutBetweenCharacters) {
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(shortened("abcd", 3), "abc...");
  EXPECT_EQ(shortened("äöü", 3), "ä...");
  EXPECT_EQ(shortened("äöü", 6), "äöü");
  EXPECT_EQ(shortened("\x80\x80\x80", 1), "...");
}

}  // namespace
}  // namespace axisfit
