#include "io/recording/csv.h"

#include <gtest/gtest.h>

#include <bit>
#include <cfloat>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <locale>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/io/recording/table_fixture.h"

namespace axisfit {
namespace {

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

TEST_F(TableTest, ReadsNamesValuesAndLines) {
  const Table table = read("time,position\n0,1.5\n0.001,-2e-3\n");
  EXPECT_EQ(table.file, path());
  ASSERT_EQ(table.columns.size(), 2u);
  EXPECT_EQ(table.columns[0].name, "time");
  EXPECT_EQ(table.columns[0].values, (Values{0, 0.001}));
  EXPECT_EQ(table.columns[1].values, (Values{1.5, -2e-3}));
  EXPECT_EQ(table.rows(), 2u);
  EXPECT_EQ(table.lines, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(table.where(1), path() + ":3");
}

TEST_F(TableTest, AcceptsWhatSpreadsheetsAndLoggersWrite) {
  const std::vector<std::string_view> variants = {
      "a,b\n1,2\n3,-4\n",  // plain
      "a,b\n1,2\n3,-4",    // no line end at the end
      // Two literals: the escape would go on. NOLINTNEXTLINE(bugprone-suspicious-missing-comma)
      "\xEF\xBB\xBF"
      "a,b\r\n1,2\r\n3,-4\r\n",                // byte-order mark, CRLF
      "a,b\n1,2\n3,-4\n\n \t\r\n\n",           // blank lines at the end
      "a;b\n1;2\n3;-4\n",                      // semicolons
      "a\tb\n1\t2\n3\t-4\n",                   // tabs
      "\"a\",\"b\"\n\"1\",2\n 3 , \"-4\" \n",  // quotes and blanks
      " a , b \n 1 , 2 \n\t3\t,\t-4\t\n",      // blanks
      "\"a\"\t b \n 1\t\"2\"\n3 \t -4\n",      // the same with tabs
      "a,b\n+1,2.\n3.0e0,-4E+00\n",            // other spellings of the numbers
      "a;b\n1,0;+2\n3;-4,00e0\n",              // decimal commas
      "a,b,\n1,2,\n3,-4, \n",                  // separators at the end of every line
  };
  for (const std::string_view text : variants) {
    SCOPED_TRACE(text);
    const Table table = read(text);
    ASSERT_EQ(table.columns.size(), 2u);
    EXPECT_EQ(table.columns[0].name, "a");
    EXPECT_EQ(table.columns[1].name, "b");
    EXPECT_EQ(table.columns[0].values, (Values{1, 3}));
    EXPECT_EQ(table.columns[1].values, (Values{2, -4}));
    EXPECT_EQ(table.lines, (std::vector<std::size_t>{2, 3}));
  }
}

std::string written(const Table& table, int significant_digits = 0) {
  std::ostringstream out;
  write_csv(out, table.columns, significant_digits);
  return out.str();
}

TEST(WriteCsv, WritesTheShortestExactOrTheRequestedDigits) {
  const Table table{"", {{"a", {0.1, 1e22, 100}}, {"b", {1.0 / 3, -0.0, 2}}}, {}};
  EXPECT_EQ(written(table), "a,b\n0.1,0.3333333333333333\n1e+22,-0\n100,2\n");
  EXPECT_EQ(written(table, 3), "a,b\n0.1,0.333\n1e+22,-0\n100,2\n");
}

TEST(WriteCsv, LeavesNoValueEmptyAndQuotesNamesThatNeedIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(written({"", {{"m(:,1)", {nan, 1}}, {"the \"raw\" one", {2, nan}}}, {}}),
            "\"m(:,1)\",\"the \"\"raw\"\" one\"\n,2\n1,\n");
}

TEST(WriteCsv, RefusesWhatTheProgramGotWrong) {
  EXPECT_THROW(written({"", {{"a", {1}}, {"b", {}}}, {}}), std::logic_error);
  EXPECT_THROW(written({"", {{"a", {1}}}, {}}, -1), std::logic_error);
  EXPECT_THROW(written({"", {{"a", {1}}}, {}}, 18), std::logic_error);
}

// All kinds of doubles: every exponent, subnormal numbers, both zeros and the limits.
Values many_doubles() {
  Values values = {0.0,      -0.0,    1.0,      0.1,           DBL_MIN,
                   -DBL_MIN, DBL_MAX, -DBL_MAX, DBL_TRUE_MIN,  9007199254740993.0,
                   1e22,     1e23,    5e-324,   123456789e-15, 0.30000000000000004};
  std::mt19937_64 bits(1);
  while (values.size() < 20000) {
    const std::uint64_t pattern = bits();
    double value = 0;
    std::memcpy(&value, &pattern, sizeof value);
    if (std::isfinite(value)) values.push_back(value);
  }
  return values;
}

TEST_F(TableTest, RoundTripIsExact) {
  const Table table{"", {{"v", many_doubles()}}, {}};
  for (const int digits : {0, 17}) {
    const Table copy = read(written(table, digits));
    ASSERT_EQ(copy.rows(), table.rows());
    for (std::size_t i = 0; i < table.rows(); ++i) {
      ASSERT_TRUE(same_bits(copy.columns[0].values[i], table.columns[0].values[i])) << i;
    }
  }
}

// Decimal commas and thousands points, whether or not the machine has a German locale.
class GermanNumbers : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST_F(TableTest, LocaleDoesNotMatter) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new GermanNumbers));
  const std::string c_before = std::setlocale(LC_ALL, nullptr);
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // as far as there is one

  const Table table{"", {{"t", {1234567.25, 0.5}}}, {}};
  const std::string text = written(table);
  const Table copy = read(text);
  std::string message = error("t,u\n0,1\n" + std::string(2000, '\n') + "1\n");

  std::setlocale(LC_ALL, c_before.c_str());
  std::locale::global(before);
  EXPECT_EQ(text, "t\n1234567.25\n0.5\n");
  EXPECT_EQ(copy.columns[0].values, table.columns[0].values);
  EXPECT_TRUE(message.starts_with("rec.csv:2003: ")) << message;
}

}  // namespace
}  // namespace axisfit
