#include "base/text_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace axisfit {
namespace {

using Rows = std::vector<std::vector<std::string>>;

TEST(TextTable, CountsCharactersNotBytes) {
  EXPECT_EQ(width_of("N s/m"), 5u);
  EXPECT_EQ(width_of("µm/s²"), 5u);
  EXPECT_EQ(width_of("\033[32mN\033[0m s/m"), 5u);
  EXPECT_EQ(format_table({{"µm", "1"}, {"mm", "2"}}, {Alignment::left, Alignment::left}),
            "  µm  1\n  mm  2\n");
}

TEST(TextTable, ANameThatIsTheReasonForALongLineStandsAboveItsNumbers) {
  const std::string wide(60, '7');
  const Rows rows{{"", wide, "unit"}, {"V_L", "2.7", "V"}, {"coulomb_friction.F_c", "25", "N"}};
  EXPECT_EQ(format_table(rows, {Alignment::left, Alignment::right, Alignment::left}),
            "       " + wide + "  unit\n" +                      //
                "  V_L  " + std::string(57, ' ') + "2.7  V\n" +  //
                "  coulomb_friction.F_c\n" +                     //
                "       " + std::string(58, ' ') + "25  N\n");
  // Where there is room, it does not.
  const Rows narrow{{"V_L", "2.7"}, {"coulomb_friction.F_c", "25"}};
  EXPECT_EQ(format_table(narrow, {Alignment::left, Alignment::right}),
            "  V_L                   2.7\n  coulomb_friction.F_c   25\n");
}

TEST(TextTable, TheLastColumnIsWrappedBesideNames) {
  std::string words;
  for (int i = 0; i < 40; ++i) words += "word ";
  std::istringstream lines(format_table({{"name", words}, {std::string(70, 'x'), words}},
                                        {Alignment::left, Alignment::wrapped}));
  std::size_t longest = 0, count = 0;
  for (std::string line; std::getline(lines, line); ++count)
    longest = std::max(longest, width_of(line));
  EXPECT_LE(longest, kTextWidth);
  EXPECT_GT(longest, kTextWidth - 10);
  EXPECT_GT(count, 4u);
}

TEST(TextTable, RowsGoOnInAnotherLineWhereTheyDoNotFit) {
  const Rows rows{{"", "value", "error", "interval", "initial value"},
                  {"mass", "146.0", "0.1", "145.8 to 146.2", "150"}};
  const std::vector<Alignment> alignment(5, Alignment::right);
  const std::string whole = format_table(rows, alignment);
  EXPECT_EQ(std::ranges::count(whole, '\n'), 2);
  {
    const TextWidth narrow(0);  // the narrowest there is
    EXPECT_EQ(TextWidth::now(), 40u);
    EXPECT_EQ(format_table(rows, alignment),
              "        value  error        interval\n"
              "    initial value\n"
              "  mass  146.0    0.1  145.8 to 146.2\n"
              "              150\n");
    EXPECT_EQ(paragraph(std::string(38, 'x') + " yy"), std::string(38, 'x') + "\nyy\n");
  }
  EXPECT_EQ(format_table(rows, alignment), whole);
}

TEST(TextTable, ANumberKeepsItsPerCentSign) {
  EXPECT_EQ(paragraph(std::string(75, 'x') + " 35 % more"), std::string(75, 'x') + " 35 %\nmore\n");
  EXPECT_EQ(paragraph(std::string(76, 'x') + " 35 % more"), std::string(76, 'x') + "\n35 % more\n");
}

}  // namespace
}  // namespace axisfit
